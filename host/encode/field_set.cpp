// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/field_set.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "host/encode/context_training.h"

namespace vitrine {
namespace {

constexpr int64_t kPreviewTexels = 5'000'000;
constexpr int64_t kMemoryBytes = int64_t{4} << 30;

int64_t leaf_texels(const FieldSource& field) { return field.space.sample_count() * field.width * field.height; }

// Every stride-th row of tiles, and at least one.
std::vector<int> preview_rows(int height, int64_t stride) {
  std::vector<int> rows;
  const int bands = (height + kTileSize - 1) / kTileSize;
  const int64_t first = std::min<int64_t>(stride, bands) / 2;
  for (int64_t band = first; band < bands; band += stride) {
    for (int y = static_cast<int>(band) * kTileSize; y < std::min(height, static_cast<int>(band + 1) * kTileSize); ++y)
      rows.push_back(y);
  }
  return rows;
}

template <typename T>
std::vector<T> cut_rows(const std::vector<T>& planes, int width, int height, const std::vector<int>& rows) {
  std::vector<T> out;
  const size_t w = static_cast<size_t>(width), count = planes.size() / (w * static_cast<size_t>(height));
  for (size_t p = 0; p < count; ++p) {
    for (const int y : rows) {
      const auto line = planes.begin() + static_cast<ptrdiff_t>((p * static_cast<size_t>(height) + static_cast<size_t>(y)) * w);
      out.insert(out.end(), line, line + width);
    }
  }
  return out;
}

AxisSizes checked_stagger(const FieldShape& shape, const AxisSizes& stagger) {
  AxisSizes out{};
  for (size_t a = 0; a < static_cast<size_t>(shape.space.axis_count); ++a) {
    out[a] = static_cast<uint8_t>(stagger[a] % shape.block_size[a]);
  }
  return out;
}

FieldJob make_job(const FieldSource& source, int64_t preview_stride, bool keep) {
  FieldJob job;
  job.source = &source;
  job.shape.space = source.space;
  job.shape.block_size = source.block_size;
  job.shape.stagger = checked_stagger(job.shape, source.stagger);
  job.textures.width = source.width;
  job.textures.height = source.height;
  job.textures.source = &source;
  weigh_texels(source.importance, source.samples_shown, job.textures);
  const size_t samples = static_cast<size_t>(source.space.sample_count());
  if (keep) job.textures.leaves.resize(samples);
  if (preview_stride == 1 && keep) return job;
  const std::vector<int> rows = preview_rows(source.height, preview_stride);
  job.preview.width = source.width;
  job.preview.height = static_cast<int>(rows.size());
  job.preview.leaves.resize(samples);
  job.preview.source = &source;
  std::vector<std::vector<float>> importance;
  for (const std::vector<float>& own : source.importance) importance.push_back(cut_rows(own, source.width, source.height, rows));
  weigh_texels(importance, source.samples_shown, job.preview);
  job.preview.reference_importance = job.textures.reference_importance;  // the steps must be those of the whole
  return job;
}

void load_leaf(FieldJob& job, size_t sample, int64_t preview_stride, bool keep) {
  CodedPlanes planes = job.source->load(static_cast<int64_t>(sample));
  if (job.preview.width > 0) {
    job.preview.leaves[sample] =
        cut_rows(planes, job.textures.width, job.textures.height, preview_rows(job.textures.height, preview_stride));
  }
  if (keep) job.textures.leaves[sample] = std::move(planes);
}

// A piece of work of a pass.
struct BlockTask {
  size_t field;
  int block;
};

}  // namespace

void FieldJob::set_pyramid(const PyramidShape& pyramid) {
  if (pyramid == setting.pyramid) return;
  setting.pyramid = shape.pyramid = pyramid;
  setting.contexts.clear();
}

std::vector<FieldJob> load_fields(const std::vector<FieldSource>& fields, Progress& progress) {
  int64_t texels = 0, samples = 0;
  for (const FieldSource& f : fields) texels += leaf_texels(f), samples += f.space.sample_count();
  const bool keep = texels * kNodePlanes * 2 <= kMemoryBytes;
  const int64_t stride = std::max<int64_t>(1, (texels + kPreviewTexels - 1) / kPreviewTexels);
  std::vector<FieldJob> jobs;
  std::vector<BlockTask> tasks;
  for (size_t f = 0; f < fields.size(); ++f) {
    jobs.push_back(make_job(fields[f], stride, keep));
    for (int64_t s = 0; s < fields[f].space.sample_count(); ++s) tasks.push_back({f, static_cast<int>(s)});
  }
  progress.begin("loading textures", samples, 0, "textures");
  tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t t) {
    load_leaf(jobs[tasks[t].field], static_cast<size_t>(tasks[t].block), stride, keep);
    progress.advance(1);
  });
  progress.end();
  return jobs;
}

double table_bytes(const FieldJob& job) {
  return 8.0 * job.shape.node_count() + 1.0 * kContextBytesPerLevel * job.shape.pyramid.level_count;
}

Pass encode_pass(const std::vector<FieldJob>& jobs, double price, bool preview, Progress& progress) {
  Pass pass;
  pass.fields.resize(jobs.size());
  std::vector<FieldCoder> coders;
  std::vector<BlockTask> tasks;
  for (size_t f = 0; f < jobs.size(); ++f) {
    coders.emplace_back(jobs[f].shape, preview ? jobs[f].preview_textures() : jobs[f].textures, jobs[f].setting, price);
    pass.fields[f].blocks.resize(static_cast<size_t>(jobs[f].shape.block_count()));
    for (int b = 0; b < jobs[f].shape.block_count(); ++b) tasks.push_back({f, b});
  }
  tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t t) {
    pass.fields[tasks[t].field].blocks[static_cast<size_t>(tasks[t].block)] = coders[tasks[t].field].encode_block(tasks[t].block);
    progress.advance(1);
  });
  for (size_t f = 0; f < jobs.size(); ++f) {
    FieldPass& field = pass.fields[f];
    const double scale = preview ? 1 / jobs[f].preview_share() : 1;
    for (const CodedBlock& block : field.blocks) {
      field.bytes += scale * static_cast<double>(block.bytes);
      field.squared_error += scale * block.squared_error;
    }
    pass.bytes += field.bytes + table_bytes(jobs[f]);
  }
  return pass;
}

void train_contexts(std::vector<FieldJob>& jobs, const Pass& pass) {
  struct LevelTask {
    size_t field, level;
  };
  std::vector<LevelTask> tasks;
  for (size_t f = 0; f < jobs.size(); ++f) {
    const size_t levels = static_cast<size_t>(jobs[f].shape.pyramid.level_count);
    jobs[f].setting.contexts.resize(levels);
    for (size_t l = 0; l < levels; ++l) tasks.push_back({f, l});
  }
  tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t t) {
    std::vector<const CodedSymbols*> nodes;
    for (const CodedBlock& block : pass.fields[tasks[t].field].blocks) {
      for (const CodedSymbols& node : block.symbols[tasks[t].level]) nodes.push_back(&node);
    }
    std::vector<uint8_t>& contexts = jobs[tasks[t].field].setting.contexts[tasks[t].level];
    contexts = train_contexts(nodes, contexts);
  });
}

}  // namespace vitrine
