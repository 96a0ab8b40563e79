// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/rendering_matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <random>

#include "host/infer/coordinate_reader.h"
#include "host/infer/filtered_matrix.h"
#include "host/infer/identifier_reader.h"
#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

class RenderingMatrixTest : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu = make_gpu();
    ASSERT_NE(gpu, nullptr);
  }
  void read(ShownObjects drawn, const InferenceOptions& o, size_t texture_bytes = size_t{1} << 30) {
    state = looking_down(drawn, static_cast<float>(o.width) / static_cast<float>(o.height), eye_height);
    objects = std::move(drawn.objects);
    sizes = std::move(drawn.sizes);
    options = o;
    renderer = std::make_unique<TestRenderer>(*gpu, options, objects);
    const GeometryState* const states[] = {&state};
    matrix = IdentifierReader(*renderer, sizes, texture_bytes).read(states)[0];
    by_coordinates = CoordinateReader(*renderer, sizes).read(states)[0];
    for (const TextureSize& size : sizes) pyramids.emplace_back(size.width, size.height);
  }
  std::vector<glm::vec4> render(const std::vector<std::vector<glm::vec4>>& texels) {
    std::vector<hal::Texture> textures;
    for (size_t i = 0; i < texels.size(); ++i)
      textures.push_back(create_pyramid_texture(*gpu, renderer->drawer(), pyramids[i], hal::TextureFormat::kRgba32f,
                                                std::as_bytes(std::span(texels[i]))));
    std::vector<glm::vec4> pixels(static_cast<size_t>(renderer->width() * renderer->height()));
    renderer->render(state, textures, pixels);
    for (const hal::Texture texture : textures) gpu->destroy(texture);
    return pixels;
  }
  // Index of a sample of the matrix in a rendered picture.
  size_t place(const ObjectMatrix& rows, uint32_t sample) const {
    const int s = options.supersampling, columns = rows.window.width * s;
    const int x = rows.window.x * s + static_cast<int>(sample) % columns,
              y = rows.window.y * s + static_cast<int>(sample) / columns;
    return static_cast<size_t>((renderer->height() - 1 - y) * renderer->width() + x);
  }

  std::unique_ptr<hal::Gpu> gpu;
  float eye_height = 0.6f;
  std::vector<DrawnObject> objects;
  std::vector<TextureSize> sizes;
  InferenceOptions options;
  std::unique_ptr<TestRenderer> renderer;
  GeometryState state;
  StateMatrix matrix, by_coordinates;
  std::vector<Pyramid> pyramids;
};

constexpr InferenceOptions kPicture{.width = 80, .height = 60};

std::vector<std::vector<glm::vec4>> random_textures(const std::vector<Pyramid>& pyramids) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(0, 1);
  std::vector<std::vector<glm::vec4>> texels;
  for (const Pyramid& pyramid : pyramids) {
    texels.emplace_back();
    for (size_t i = 0; i < pyramid.size(); ++i) texels.back().emplace_back(any(random), any(random), any(random), texels.size());
  }
  return texels;
}

constexpr SurfaceFilter kFilters[] = {SurfaceFilter::kBilinear, SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic2,
                                      SurfaceFilter::kAnisotropic4};

// Every level has random texels of its own, so any weight on a wrong texel shows. The bound is what is asked of a float device.
TEST_F(RenderingMatrixTest, TheMatrixTimesATextureIsItsRendering) {
  for (const SurfaceFilter filter : kFilters)
    for (const auto& [width, height] : {std::pair{64, 64}, std::pair{40, 72}, std::pair{37, 101}, std::pair{256, 8}}) {
      SCOPED_TRACE(::testing::Message() << "filter " << static_cast<int>(filter) << ", texture " << width << " x " << height);
      pyramids.clear();
      InferenceOptions o = kPicture;
      o.filter = filter;
      read(board_and_card(width, height, 24, 16), o);
      const auto texels = random_textures(pyramids);
      const auto pixels = render(texels);
      for (const StateMatrix* read : {&matrix, &by_coordinates}) {
        size_t seen = 0;
        for (size_t i = 0; i < read->size(); ++i) {
          const ObjectMatrix& rows = (*read)[i];
          for (size_t s = 0; s < rows.samples.size(); ++s) {
            glm::vec4 sum(0);
            for (uint32_t e = rows.starts[s]; e < rows.starts[s + 1]; ++e)
              sum += rows.entries[e].weight * texels[i][rows.entries[e].texel];
            const glm::vec4 difference = glm::abs(sum - pixels[place(rows, rows.samples[s])]);
            ASSERT_LT(std::max({difference.x, difference.y, difference.z}), 1e-5f)
                << (read == &matrix ? "identifiers" : "coordinates") << ", object " << i << ", sample " << s;
            ++seen;
          }
        }
        EXPECT_EQ(seen, static_cast<size_t>(
                            std::count_if(pixels.begin(), pixels.end(), [](const glm::vec4& p) { return p.w > 0.5f; })));
      }
    }
}

TEST_F(RenderingMatrixTest, BothWaysToReadTheMatrixGiveTheSame) {
  for (const SurfaceFilter filter : kFilters) {
    InferenceOptions o = kPicture;
    o.filter = filter;
    read(board_and_card(120, 72, 24, 16), o);
    EXPECT_LT(largest_difference(matrix, by_coordinates), 1e-5f) << "filter " << static_cast<int>(filter);
  }
}

TEST_F(RenderingMatrixTest, ADeviceThatFollowsTheFormulaIsReadWithOneRenderingATap) {
  InferenceOptions o = kPicture;
  for (const SurfaceFilter filter : {SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic4}) {
    o.filter = filter;
    read(board_and_card(64, 64, 24, 16), o);
    const auto reader = make_matrix_reader(choose_matrix_method(*renderer, sizes, state), *renderer, sizes);
    ASSERT_STREQ(reader->method(), "coordinates");
    const int64_t before = reader->renderings();
    const GeometryState* const states[] = {&state, &state, &state};
    reader->read(states);
    EXPECT_EQ(reader->renderings() - before, 3 * tap_count(filter));
  }
}

// Where the footprint is long, more taps read finer levels: that is what they are for.
TEST_F(RenderingMatrixTest, MoreTapsReadFinerLevelsWhereTheFootprintIsLong) {
  eye_height = -0.6f;  // flat above the board
  const auto mean_level = [&](SurfaceFilter filter) {
    InferenceOptions o = kPicture;
    o.filter = filter;
    pyramids.clear();
    read(board_and_card(256, 256, 24, 16), o);
    double sum = 0;
    for (const MatrixEntry& e : matrix[0].entries) {
      size_t level = 0;
      while (level + 1 < pyramids[0].levels().size() && e.texel >= pyramids[0].levels()[level + 1].offset) ++level;
      sum += static_cast<double>(e.weight) * static_cast<double>(level);
    }
    return sum / static_cast<double>(matrix[0].samples.size());
  };
  const double one = mean_level(SurfaceFilter::kTrilinear), two = mean_level(SurfaceFilter::kAnisotropic2),
               four = mean_level(SurfaceFilter::kAnisotropic4);
  EXPECT_GT(one, two + 0.1);
  EXPECT_GT(two, four + 0.1);
  EXPECT_NEAR(mean_level(SurfaceFilter::kBilinear), 0, 1e-5);
}

TEST_F(RenderingMatrixTest, WeightsOfASampleSumToOne) {
  read(board_and_card(64, 104, 16, 16), kPicture);
  bool trilinear = false;
  for (const ObjectMatrix& rows : matrix)
    for (size_t s = 0; s < rows.samples.size(); ++s) {
      double sum = 0;
      for (uint32_t e = rows.starts[s]; e < rows.starts[s + 1]; ++e) sum += static_cast<double>(rows.entries[e].weight);
      ASSERT_NEAR(sum, 1, 1e-5);
      trilinear |= rows.starts[s + 1] - rows.starts[s] == 8;
    }
  EXPECT_TRUE(trilinear) << "the picture does not test minification";
}

// The definition (Hakura 2001, section 3.4.1): one texel at a time.
TEST_F(RenderingMatrixTest, IdentifiersFindWhatSingleTexelsFind) {
  InferenceOptions small{.width = 24, .height = 18};
  read(board_and_card(13, 22, 5, 9), small);
  for (size_t i = 0; i < matrix.size(); ++i) {
    std::map<std::pair<size_t, uint32_t>, float> weights;  // (place, texel)
    for (size_t s = 0; s < matrix[i].samples.size(); ++s)
      for (uint32_t e = matrix[i].starts[s]; e < matrix[i].starts[s + 1]; ++e)
        weights[{place(matrix[i], matrix[i].samples[s]), matrix[i].entries[e].texel}] = matrix[i].entries[e].weight;
    for (uint32_t texel = 0; texel < pyramids[i].size(); ++texel) {
      std::vector<std::vector<glm::vec4>> texels;
      for (const Pyramid& pyramid : pyramids) texels.emplace_back(pyramid.size(), glm::vec4(0));
      texels[i][texel] = glm::vec4(1);
      const auto pixels = render(texels);
      for (size_t p = 0; p < pixels.size(); ++p) {
        const auto found = weights.find({p, texel});
        ASSERT_NEAR(pixels[p].x, found == weights.end() ? 0 : found->second, 2e-6) << "object " << i << ", texel " << texel;
      }
    }
  }
}

TEST_F(RenderingMatrixTest, WithLittleTextureMemoryTheMatrixIsTheSame) {
  read(board_and_card(64, 64, 24, 16), kPicture);
  const StateMatrix whole = matrix;
  read(board_and_card(64, 64, 24, 16), kPicture, 0);
  for (size_t i = 0; i < matrix.size(); ++i) {
    EXPECT_EQ(matrix[i].samples, whole[i].samples);
    EXPECT_EQ(matrix[i].starts, whole[i].starts);
  }
}

// <F A x, y> = <x, A' F' y>, and F A x is what the target's resolve would average.
TEST_F(RenderingMatrixTest, FilteringAndItsTransposeAreAdjoint) {
  for (const int supersampling : {1, 2, 3, 4}) {
    pyramids.clear();
    InferenceOptions o = kPicture;
    o.supersampling = supersampling;
    read(board_and_card(40, 56, 24, 16), o);
    for (size_t i = 0; i < matrix.size(); ++i) {
      const FilteredMatrix filtered(matrix[i], supersampling, o.width, o.height);
      std::mt19937 random(5);
      std::uniform_real_distribution<float> any(-1, 1);
      std::vector<float> x(pyramids[i].size()), y(filtered.pixel_count()), fax(filtered.pixel_count()), aty(pyramids[i].size());
      for (float& v : x) v = any(random);
      for (float& v : y) v = any(random);
      filtered.apply(x.data(), fax.data());
      filtered.add_transposed(y.data(), aty.data());
      double left = 0, right = 0;
      for (size_t p = 0; p < y.size(); ++p) left += static_cast<double>(fax[p]) * static_cast<double>(y[p]);
      for (size_t t = 0; t < x.size(); ++t) right += static_cast<double>(x[t]) * static_cast<double>(aty[t]);
      EXPECT_NEAR(left, right, 1e-4 * (1 + std::fabs(left))) << "supersampling " << supersampling;
    }
  }
}

TEST_F(RenderingMatrixTest, TheFilterIsThatOfTheResolvePass) {
  for (const int supersampling : {1, 2, 3}) {
    pyramids.clear();
    InferenceOptions o = kPicture;
    o.supersampling = supersampling;
    read(board_and_card(40, 56, 24, 16), o);
    const auto texels = random_textures(pyramids);
    const auto pixels = render(texels);
    const ResolveTaps taps = resolve_taps(supersampling);
    const FilteredMatrix filtered(matrix[1], supersampling, o.width, o.height);
    std::vector<float> red(pyramids[1].size()), result(filtered.pixel_count());
    for (size_t t = 0; t < red.size(); ++t) red[t] = texels[1][t].x;
    filtered.apply(red.data(), result.data());
    const PixelWindow& window = filtered.window();
    for (int y = 0; y < window.height; ++y)
      for (int x = 0; x < window.width; ++x) {
        float sum = 0, cover = 0;
        for (int j = 0; j < taps.count; ++j)
          for (int k = 0; k < taps.count; ++k) {
            const int sx = (window.x + x) * supersampling + taps.first + k, sy = (window.y + y) * supersampling + taps.first + j;
            if (sx < 0 || sy < 0 || sx >= renderer->width() || sy >= renderer->height()) continue;
            const glm::vec4& p = pixels[static_cast<size_t>((renderer->height() - 1 - sy) * renderer->width() + sx)];
            if (std::fabs(p.w - 2) > 0.5f) continue;
            const float w = taps.weight[static_cast<size_t>(k)] * taps.weight[static_cast<size_t>(j)];
            sum += w * p.x;
            cover += w;
          }
        const size_t p = static_cast<size_t>(y * window.width + x);
        ASSERT_NEAR(result[p], sum, 1e-4);
        ASSERT_NEAR(filtered.filtered()[p], cover, 1e-4);
      }
  }
}

}  // namespace
}  // namespace vitrine::testing
