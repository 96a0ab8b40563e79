// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_materials.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "host/scene/picture.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr double kLarge = 1e9;                       // of factors without an upper bound of their own
constexpr double kSlack = 1e-3;                      // exporters write 1.0000001
constexpr int64_t kMostPixels = int64_t{256} << 20;  // of all pictures of a model together

float unit_or(const JsonView& place, const char* key, double otherwise) {
  return static_cast<float>(std::clamp(place.number_or(key, otherwise, -kSlack, 1 + kSlack), 0.0, 1.0));
}

float positive_or(const JsonView& place, const char* key, double otherwise) {
  return static_cast<float>(place.number_or(key, otherwise, 0, kLarge));
}

template <size_t N>
std::array<float, N> colour_or(const JsonView& place, const char* key, std::array<float, N> otherwise, double most) {
  if (const auto member = place.find(key)) member->numbers(otherwise, -kSlack, most + kSlack);
  for (float& c : otherwise) c = std::clamp(c, 0.0f, static_cast<float>(most));
  return otherwise;
}

glm::vec3 rgb_or(const JsonView& place, const char* key, float otherwise, double most) {
  const std::array<float, 3> c = colour_or<3>(place, key, {otherwise, otherwise, otherwise}, most);
  return {c[0], c[1], c[2]};
}

Wrap wrap_of(const JsonView& sampler, const char* key) {
  const int64_t mode = sampler.integer_or(key, 10497, 0, 65535);
  if (mode == 10497) return Wrap::kRepeat;
  if (mode == 33648) return Wrap::kMirror;
  if (mode == 33071) return Wrap::kClamp;
  sampler.at(key).fail(fmt::format("{} is not a wrapping mode", mode));
}

AlphaMode alpha_mode_of(const JsonView& place) {
  const std::string mode = place.text_or("alphaMode", "OPAQUE");
  if (mode == "OPAQUE") return AlphaMode::kOpaque;
  if (mode == "MASK") return AlphaMode::kMask;
  if (mode == "BLEND") return AlphaMode::kBlend;
  place.at("alphaMode").fail(in_quotes(mode) + " is not OPAQUE, MASK or BLEND");
}

}  // namespace

glm::mat3 texture_transform(glm::vec2 offset, float rotation, glm::vec2 scale) {
  const float c = std::cos(rotation), s = std::sin(rotation);
  return {c * scale.x, -s * scale.x, 0, s * scale.y, c * scale.y, 0, offset.x, offset.y, 1};
}

int GltfMaterials::use(int gltf_material) {
  const auto known = material_of_.find(gltf_material);
  if (known != material_of_.end()) return known->second;
  Material material;
  material.name = "default";
  if (gltf_material >= 0) material = read(document_.element("materials", gltf_material));
  materials_->push_back(std::move(material));
  return material_of_[gltf_material] = static_cast<int>(materials_->size()) - 1;
}

Material GltfMaterials::read(const JsonView& place) {
  Material material;
  material.name = printable(place.text_or("name", "material"));
  read_metallic_roughness(place, material);
  material.normal_texture = texture(place, "normalTexture");
  if (material.normal_texture)
    material.normal_scale = static_cast<float>(place.at("normalTexture").number_or("scale", 1, -kLarge, kLarge));
  material.emissive = rgb_or(place, "emissiveFactor", 0, kLarge);
  if (const auto strength = place.extension("KHR_materials_emissive_strength"))
    material.emissive *= positive_or(*strength, "emissiveStrength", 1);
  material.emissive_texture = texture(place, "emissiveTexture");
  material.alpha_mode = alpha_mode_of(place);
  material.alpha_cutoff = positive_or(place, "alphaCutoff", 0.5);
  material.double_sided = place.boolean_or("doubleSided", false);
  material.unlit = place.extension("KHR_materials_unlit").has_value();
  read_specular(place, material);
  read_transmission(place, material);
  read_clearcoat(place, material);
  return material;
}

void GltfMaterials::read_metallic_roughness(const JsonView& place, Material& material) {
  const auto pbr = place.find("pbrMetallicRoughness");
  if (!pbr) return;
  const std::array<float, 4> base = colour_or<4>(*pbr, "baseColorFactor", {1, 1, 1, 1}, 1);
  material.base_color = {base[0], base[1], base[2], base[3]};
  material.base_color_texture = texture(*pbr, "baseColorTexture");
  material.metallic = unit_or(*pbr, "metallicFactor", 1);
  material.roughness = unit_or(*pbr, "roughnessFactor", 1);
  material.metallic_roughness_texture = texture(*pbr, "metallicRoughnessTexture");
}

void GltfMaterials::read_specular(const JsonView& place, Material& material) {
  if (const auto ior = place.extension("KHR_materials_ior")) {
    material.ior = positive_or(*ior, "ior", 1.5);
    if (material.ior != 0 && material.ior < 1) ior->at("ior").fail("must be 0 or at least 1");
  }
  const auto specular = place.extension("KHR_materials_specular");
  if (!specular) return;
  material.specular = unit_or(*specular, "specularFactor", 1);
  material.specular_texture = texture(*specular, "specularTexture");
  material.specular_color = rgb_or(*specular, "specularColorFactor", 1, kLarge);
  material.specular_color_texture = texture(*specular, "specularColorTexture");
}

void GltfMaterials::read_transmission(const JsonView& place, Material& material) {
  if (const auto transmission = place.extension("KHR_materials_transmission")) {
    material.transmission = unit_or(*transmission, "transmissionFactor", 0);
    material.transmission_texture = texture(*transmission, "transmissionTexture");
  }
  const auto volume = place.extension("KHR_materials_volume");
  if (!volume) return;
  material.thickness = positive_or(*volume, "thicknessFactor", 0);
  material.thickness_texture = texture(*volume, "thicknessTexture");
  material.attenuation_color = rgb_or(*volume, "attenuationColor", 1, 1);
  material.attenuation_distance = positive_or(*volume, "attenuationDistance", 0);
}

void GltfMaterials::read_clearcoat(const JsonView& place, Material& material) {
  const auto coat = place.extension("KHR_materials_clearcoat");
  if (!coat) return;
  material.clearcoat = unit_or(*coat, "clearcoatFactor", 0);
  material.clearcoat_texture = texture(*coat, "clearcoatTexture");
  material.clearcoat_roughness = unit_or(*coat, "clearcoatRoughnessFactor", 0);
  material.clearcoat_roughness_texture = texture(*coat, "clearcoatRoughnessTexture");
  material.clearcoat_normal_texture = texture(*coat, "clearcoatNormalTexture");
  if (material.clearcoat_normal_texture)
    material.clearcoat_normal_scale =
        static_cast<float>(coat->at("clearcoatNormalTexture").number_or("scale", 1, -kLarge, kLarge));
}

TextureRef GltfMaterials::texture(const JsonView& owner, const char* key) {
  TextureRef ref;
  const auto info = owner.find(key);
  if (!info) return ref;
  int64_t set = info->integer_or("texCoord", 0, 0, 1000);
  if (const auto transform = info->extension("KHR_texture_transform")) {
    std::array<float, 2> offset{0, 0}, scale{1, 1};
    if (const auto member = transform->find("offset")) member->numbers(offset, -kLarge, kLarge);
    if (const auto member = transform->find("scale")) member->numbers(scale, -kLarge, kLarge);
    const float rotation = static_cast<float>(transform->number_or("rotation", 0, -kLarge, kLarge));
    ref.transform = texture_transform({offset[0], offset[1]}, rotation, {scale[0], scale[1]});
    set = transform->integer_or("texCoord", set, 0, 1000);
  }
  if (set > 1) {
    document_.warn(
        fmt::format("{} uses texture coordinate set {}, but only sets 0 and 1 are read; it is left out", info->where(), set));
    return ref;
  }
  ref.texcoord = static_cast<int>(set);
  const int index = info->index_or_none("index", "textures", document_.count("textures"));
  if (index < 0) info->fail("names no texture");
  const JsonView place = document_.element("textures", index);
  read_sampler(place, ref);
  ref.image = image_of_texture(place);
  return ref;
}

void GltfMaterials::read_sampler(const JsonView& place, TextureRef& ref) {
  const int index = place.index_or_none("sampler", "samplers", document_.count("samplers"));
  if (index < 0) return;
  const JsonView sampler = document_.element("samplers", index);
  ref.wrap_s = wrap_of(sampler, "wrapS");
  ref.wrap_t = wrap_of(sampler, "wrapT");
  const int64_t filter = sampler.integer_or("magFilter", 9729, 0, 65535);
  if (filter != 9728 && filter != 9729) sampler.at("magFilter").fail(fmt::format("{} is not a filter", filter));
  ref.nearest = filter == 9728;
}

int GltfMaterials::image_of_texture(const JsonView& place) {
  const size_t images = document_.count("images");
  if (const auto webp = place.extension("EXT_texture_webp")) {
    const int index = webp->index_or_none("source", "images", images);
    if (index >= 0) return use_image(index);
  }
  const int index = place.index_or_none("source", "images", images);
  if (index < 0) document_.warn(place.where() + " has no picture that is read; its factor counts alone");
  return index < 0 ? -1 : use_image(index);
}

int GltfMaterials::use_image(int gltf_image) {
  const auto known = image_of_.find(gltf_image);
  if (known != image_of_.end()) return known->second;
  images_->push_back(read_image(document_.element("images", gltf_image)));
  return image_of_[gltf_image] = static_cast<int>(images_->size()) - 1;
}

Image GltfMaterials::read_image(const JsonView& place) {
  const auto uri = place.find("uri");
  Bytes loaded;
  std::span<const uint8_t> bytes;
  if (uri) {
    bytes = loaded = document_.load_uri(*uri);
  } else {
    const int view = place.index_or_none("bufferView", "bufferViews", document_.count("bufferViews"));
    if (view < 0) place.fail("has neither \"uri\" nor \"bufferView\"");
    bytes = document_.buffer_view(view);
  }
  Image image;
  try {
    image = decode_picture(bytes);
  } catch (const std::runtime_error& e) {
    const std::string what = uri && !is_data_uri(uri->text()) ? in_quotes(uri->text()) + ' ' + e.what() : e.what();
    place.fail(what, "save the picture anew as 8-bit PNG or JPEG");
  }
  pixels_ += int64_t{image.width} * image.height;
  if (pixels_ > kMostPixels) place.fail("the model's pictures have more than 256 Mpixel together", "reduce them");
  image.name = printable(place.text_or("name", uri && !is_data_uri(uri->text()) ? uri->text() : "image"));
  return image;
}

}  // namespace vitrine
