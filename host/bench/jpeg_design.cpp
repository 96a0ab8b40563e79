// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
// clang-format off
#include <cstdio>  // jpeglib.h needs it
#include <jpeglib.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "host/bench/decode_rates.h"

namespace vitrine {
namespace {

constexpr int kMiddle = 128;

// Codes to samples: 128 + (code - centre) * gain.
struct Scaling {
  double centre = 0, gain = 1;
};

Scaling scaling_of(std::span<const int16_t> plane) {
  const auto [low, high] = std::minmax_element(plane.begin(), plane.end());
  const double range = *high - *low;
  return {(*high + *low) / 2.0, range > 254 ? 254 / range : 1.0};
}

// Rows and columns of whole blocks, as raw data comes.
int padded(int size) { return (size + DCTSIZE - 1) / DCTSIZE * DCTSIZE; }

// Rows of one plane for raw data.
struct Rows {
  std::array<JSAMPROW, DCTSIZE> rows;
  void set(JSAMPLE* plane, int stride, JDIMENSION first) {
    for (size_t y = 0; y < DCTSIZE; ++y) rows[y] = plane + (first + y) * static_cast<size_t>(stride);
  }
};
template <typename Transfer>
void transfer_rows(JSAMPLE* planes, int width, int height, const Transfer& transfer) {
  const size_t size = static_cast<size_t>(width) * static_cast<size_t>(height);
  std::array<Rows, 3> rows;
  JSAMPARRAY components[3] = {rows[0].rows.data(), rows[1].rows.data(), rows[2].rows.data()};
  for (JDIMENSION y = 0; y < static_cast<JDIMENSION>(height); y += DCTSIZE) {
    for (size_t p = 0; p < 3; ++p) rows[p].set(planes + p * size, width, y);
    transfer(components);
  }
}

class JpegDesign : public NodeDesign {
 public:
  JpegDesign(std::span<const NodePicture> pictures, double scale) : pictures_(pictures) {
    decoder_.err = jpeg_std_error(&errors_);  // ends the program: only what was coded here is decoded
    jpeg_create_decompress(&decoder_);
    for (const NodePicture& picture : pictures) encode(picture, scale);
  }
  ~JpegDesign() override {
    jpeg_destroy_decompress(&decoder_);
    for (const Coded& coded : coded_) std::free(coded.bytes);
  }
  JpegDesign(const JpegDesign&) = delete;
  JpegDesign& operator=(const JpegDesign&) = delete;

  size_t coded_bytes(size_t picture) const override { return coded_[picture].size; }
  size_t decoded_bytes(size_t picture) const override {
    const NodeDesc& desc = pictures_[picture].desc;
    return 3 * static_cast<size_t>(padded(desc.width)) * static_cast<size_t>(padded(desc.height));
  }

  void decode(size_t picture, std::byte* out) override {
    const NodeDesc& desc = pictures_[picture].desc;
    jpeg_mem_src(&decoder_, coded_[picture].bytes, coded_[picture].size);
    jpeg_read_header(&decoder_, TRUE);
    decoder_.out_color_space = JCS_YCbCr;
    decoder_.raw_data_out = TRUE;
    jpeg_start_decompress(&decoder_);
    transfer_rows(reinterpret_cast<JSAMPLE*>(out), padded(desc.width), padded(desc.height),
                  [&](JSAMPARRAY* components) { jpeg_read_raw_data(&decoder_, components, DCTSIZE); });
    jpeg_finish_decompress(&decoder_);
  }

  CodedPlanes planes_of(size_t picture, const std::byte* out) const override {
    const NodeDesc& desc = pictures_[picture].desc;
    const int stride = padded(desc.width);
    CodedPlanes planes;
    for (size_t p = 0; p < 3; ++p) {
      const Scaling& scaling = coded_[picture].scaling[p];
      const auto* samples = reinterpret_cast<const JSAMPLE*>(out) + p * decoded_bytes(picture) / 3;
      for (int y = 0; y < desc.height; ++y)
        for (int x = 0; x < desc.width; ++x)
          planes.push_back(static_cast<int16_t>(std::lround((samples[y * stride + x] - kMiddle) / scaling.gain + scaling.centre)));
    }
    return planes;
  }

 private:
  struct Coded {
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    std::array<Scaling, 3> scaling;
  };

  // Beyond the picture its last texels go on.
  static std::vector<JSAMPLE> samples_of(const NodePicture& picture, const std::array<Scaling, 3>& scaling) {
    const int width = picture.desc.width, height = picture.desc.height;
    std::vector<JSAMPLE> samples;
    for (size_t p = 0; p < 3; ++p)
      for (int y = 0; y < padded(height); ++y)
        for (int x = 0; x < padded(width); ++x) {
          const size_t at = static_cast<size_t>(std::min(y, height - 1) * width + std::min(x, width - 1));
          const double value = (picture.source[p * picture.texels() + at] - scaling[p].centre) * scaling[p].gain;
          samples.push_back(static_cast<JSAMPLE>(std::clamp(std::lround(value) + kMiddle, 0L, 255L)));
        }
    return samples;
  }

  static void set_components(jpeg_compress_struct& encoder, const NodePicture& picture, const Coded& coded, double scale) {
    for (int p = 0; p < 3; ++p) {
      const size_t plane = static_cast<size_t>(p);
      const double step = scale * picture.desc.steps[p] / kStepUnitsPerCode * coded.scaling[plane].gain;
      std::array<unsigned int, DCTSIZE2> table;
      table.fill(static_cast<unsigned int>(std::clamp(std::lround(step), 1L, 255L)));
      jpeg_add_quant_table(&encoder, p, table.data(), 100, TRUE);
      encoder.comp_info[p].quant_tbl_no = p;
      encoder.comp_info[p].h_samp_factor = encoder.comp_info[p].v_samp_factor = 1;
    }
  }

  void encode(const NodePicture& picture, double scale) {
    Coded coded;
    const std::span<const int16_t> source(picture.source);
    for (size_t p = 0; p < 3; ++p) coded.scaling[p] = scaling_of(source.subspan(p * picture.texels(), picture.texels()));
    std::vector<JSAMPLE> samples = samples_of(picture, coded.scaling);
    jpeg_error_mgr errors;
    jpeg_compress_struct encoder;
    encoder.err = jpeg_std_error(&errors);
    jpeg_create_compress(&encoder);
    jpeg_mem_dest(&encoder, &coded.bytes, &coded.size);
    encoder.image_width = static_cast<JDIMENSION>(picture.desc.width);
    encoder.image_height = static_cast<JDIMENSION>(picture.desc.height);
    encoder.input_components = 3;
    encoder.in_color_space = JCS_YCbCr;
    jpeg_set_defaults(&encoder);
    set_components(encoder, picture, coded, scale);
    encoder.optimize_coding = TRUE;
    encoder.raw_data_in = TRUE;
    jpeg_start_compress(&encoder, TRUE);
    transfer_rows(samples.data(), padded(picture.desc.width), padded(picture.desc.height),
                  [&](JSAMPARRAY* components) { jpeg_write_raw_data(&encoder, components, DCTSIZE); });
    jpeg_finish_compress(&encoder);
    jpeg_destroy_compress(&encoder);
    coded_.push_back(coded);
  }

  std::span<const NodePicture> pictures_;
  std::vector<Coded> coded_;
  jpeg_decompress_struct decoder_;
  jpeg_error_mgr errors_;
};

}  // namespace

std::unique_ptr<NodeDesign> jpeg_design(std::span<const NodePicture> pictures, double scale) {
  return std::make_unique<JpegDesign>(pictures, scale);
}

}  // namespace vitrine
