// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Materials, textures and images (glTF 2.0, sections 3.8 and 3.9; the KHR_materials extensions). Only what the scene uses
// is read and decoded.
#pragma once

#include <map>
#include <vector>

#include "host/scene/gltf_document.h"
#include "host/scene/scene.h"

namespace vitrine {

class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, std::vector<Material>* materials, std::vector<Image>* images)
      : document_(document), materials_(materials), images_(images) {}

  // Index in `materials` of a glTF material, read at first use; -1 is glTF's default material.
  int use(int gltf_material);

 private:
  Material read(const JsonView& place);
  void read_metallic_roughness(const JsonView& place, Material& material);
  void read_specular(const JsonView& place, Material& material);
  void read_transmission(const JsonView& place, Material& material);
  void read_clearcoat(const JsonView& place, Material& material);
  TextureRef texture(const JsonView& owner, const char* key);
  void read_sampler(const JsonView& place, TextureRef& ref);
  int image_of_texture(const JsonView& place);
  int use_image(int gltf_image);
  Image read_image(const JsonView& place);

  GltfDocument& document_;
  std::vector<Material>* materials_;
  std::vector<Image>* images_;
  std::map<int, int> material_of_, image_of_;
  int64_t pixels_ = 0;
};

// KHR_texture_transform as a matrix on (u, v, 1): scale, then rotation (counter-clockwise as seen on the picture, whose v
// points down), then offset.
glm::mat3 texture_transform(glm::vec2 offset, float rotation, glm::vec2 scale);

}  // namespace vitrine
