// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/commands/compression_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/commands/html.h"
#include "tools/png.h"

namespace vitrine {
namespace {

constexpr const char* kStyle =
    "body{max-width:80em}figure{display:inline-block;margin:0 .5em 1em 0}figcaption{font-size:12px}img{image-rendering:pixelated}"
    "svg text{font:12px sans-serif}";
constexpr const char* kColours[] = {"#c0392b", "#2471a3", "#1e8449", "#b9770e", "#7d3c98",
                                    "#117a65", "#616a6b", "#d35400", "#2e4053"};
constexpr int kPlotWidth = 560, kPlotHeight = 420, kLegendWidth = 320, kMargin = 50;
constexpr int kCropShare = 3;  // of the picture's width and height

std::string base64(const std::vector<std::byte>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t j = 0; j < 3; ++j) group = group << 8 | (i + j < bytes.size() ? std::to_integer<uint32_t>(bytes[i + j]) : 0);
    for (size_t j = 0; j < 4; ++j) text += i + j <= bytes.size() ? kDigits[group >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

Picture crop(const Picture& picture, const Window& window) {
  Picture result{window.width, window.height, {}};
  for (int y = 0; y < window.height; ++y) {
    const auto* row = picture.rgb.data() + 3 * (static_cast<size_t>(window.y + y) * picture.width + window.x);
    result.rgb.insert(result.rgb.end(), row, row + 3 * window.width);
  }
  return result;
}

// Where the coders' pictures are worst, all together.
Window worst_window(const CompressionReport& report) {
  Window best{0, 0, std::max(1, report.width / kCropShare), std::max(1, report.height / kCropShare)};
  const Window size = best;
  double most = -1;
  for (int y = 0; y + size.height <= report.height; y += std::max(1, size.height / 4))
    for (int x = 0; x + size.width <= report.width; x += std::max(1, size.width / 4)) {
      const Window window{x, y, size.width, size.height};
      const Picture truth = crop(report.truth, window);
      double sum = 0;
      for (const CompressionSeries& series : report.series)
        for (const CompressionRow& row : series.rows) sum += mean_squared_error(crop(row.shown, window), truth);
      if (sum > most) most = sum, best = window;
    }
  return best;
}

std::string figure(const Picture& picture, int magnification, const std::string& caption) {
  return fmt::format("<figure><img width={} height={} src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
                     picture.width * magnification, picture.height * magnification,
                     base64(png_of(picture.width, picture.height, picture.rgb)), caption);
}

std::string table(const CompressionReport& report, size_t target) {
  std::string html = "<table><tr><th>coder<th>ratio<th>bytes<th>PSNR, dB<th>decodes an access<th>ms an access<th>settings</tr>\n";
  for (const CompressionSeries& series : report.series) {
    const CompressionRow& row = series.rows[target];
    html += fmt::format(
        "<tr><td>{}<td class=n>{:.0f}:1<td class=n>{:.0f}<td class=n>{:.2f}<td class=n>{}<td class=n>{:.2f}<td>{}</tr>\n",
        series.coder, row.ratio, row.bytes, row.psnr_db, row.decodes_per_access, row.decode_ms, html_escaped(row.settings));
  }
  return html + "</table>\n";
}

// Bytes (logarithmic) to the right, PSNR upwards.
class Plot {
 public:
  explicit Plot(const CompressionReport& report) : report_(report) {
    for (const CompressionSeries& series : report.series)
      for (const RatePsnr& point : series.points) {
        if (!near_targets(point)) continue;
        least_bytes_ = std::min(least_bytes_, point.bytes), most_bytes_ = std::max(most_bytes_, point.bytes);
        least_psnr_ = std::min(least_psnr_, point.psnr_db), most_psnr_ = std::max(most_psnr_, point.psnr_db);
      }
    least_psnr_ = std::floor(least_psnr_), most_psnr_ = std::ceil(most_psnr_);
  }

  std::string svg() const {
    std::string text = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\">\n",
                                   kPlotWidth + kLegendWidth, kPlotHeight);
    text += axes();
    for (size_t i = 0; i < report_.series.size(); ++i) text += curve(i);
    return text + "</svg>\n";
  }

 private:
  // The search for a coder's choices strays far: what lies beyond twice the largest and half the smallest target says nothing
  // here.
  bool near_targets(const RatePsnr& point) const {
    double least = INFINITY, most = 0;
    for (const CompressionRow& row : report_.series[0].rows) {
      const double bytes = report_.raw_bytes / row.ratio_target;
      least = std::min(least, bytes), most = std::max(most, bytes);
    }
    return point.bytes >= least / 2 && point.bytes <= 2 * most;
  }
  double x_of(double bytes) const {
    return kMargin +
           (kPlotWidth - 2 * kMargin) * std::log(bytes / least_bytes_) / std::max(1e-9, std::log(most_bytes_ / least_bytes_));
  }
  double y_of(double psnr) const {
    return kPlotHeight - kMargin - (kPlotHeight - 2 * kMargin) * (psnr - least_psnr_) / std::max(1e-9, most_psnr_ - least_psnr_);
  }
  std::string axes() const {
    std::string text;
    for (double psnr = least_psnr_; psnr <= most_psnr_; ++psnr)
      text += fmt::format(
          "<path d=\"M{0} {1:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.0f} dB</text>\n",
          kMargin, y_of(psnr), kPlotWidth - kMargin, kMargin - 6, y_of(psnr) + 4, psnr);
    for (const CompressionRow& row : report_.series[0].rows) {
      const double x = x_of(report_.raw_bytes / row.ratio_target);
      text += fmt::format(
          "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#999\"/><text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:.0f}:1</text>\n",
          x, kMargin, kPlotHeight - kMargin, kPlotHeight - kMargin + 18, row.ratio_target);
    }
    return text;
  }
  std::string curve(size_t number) const {
    const CompressionSeries& series = report_.series[number];
    const char* colour = kColours[number % std::size(kColours)];
    // Coded textures are drawn whole, videos of textures dashed, videos of pictures dotted.
    const bool video = series.kind != CoderKind::kVitrine;
    const std::string line =
        fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-dasharray=\"{}\"", colour, video ? 1.5 : 3,
                    !video                                    ? "none"
                    : series.kind == CoderKind::kTextureVideo ? "8 3"
                                                              : "2 3");
    std::string path;
    for (const RatePsnr& point : series.points)
      if (near_targets(point))
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_of(point.bytes), y_of(point.psnr_db));
    const double y = kMargin + 18.0 * static_cast<double>(number);
    return fmt::format("<path d=\"{0}\" {1}/><path d=\"M{2} {3}h30\" {1}/><text x=\"{4}\" y=\"{5}\">{6}</text>\n", path, line,
                       kPlotWidth, y, kPlotWidth + 38, y + 4, series.coder);
  }

  const CompressionReport& report_;
  double least_bytes_ = INFINITY, most_bytes_ = 0, least_psnr_ = INFINITY, most_psnr_ = -INFINITY;
};

std::string close_ups(const CompressionReport& report, size_t target, const Window& window) {
  const int magnification = std::max(1, 320 / window.width);
  std::string html = figure(crop(report.truth, window), magnification, "ground truth");
  for (const CompressionSeries& series : report.series) {
    const CompressionRow& row = series.rows[target];
    html += figure(crop(row.shown, window), magnification,
                   fmt::format("{}: {:.2f} dB at {:.0f}:1", series.coder, row.psnr_db, row.ratio));
  }
  return html;
}

}  // namespace

void write_compression_page(const std::filesystem::path& file, const CompressionReport& report) {
  const std::string title = "Compression: " + html_escaped(report.scene);
  std::string html = fmt::format("<!doctype html><meta charset=utf-8><title>{0}</title><style>{1}{2}</style><h1>{0}</h1>\n",
                                 title, kPageStyle, kStyle);
  html += fmt::format(
      "<p>{} samples of {} x {} pixels, {:.0f} bytes as 24-bit pictures. PSNR of the framebuffer over all samples; textures "
      "before any coding "
      "reach {:.2f} dB. Textures are charged {:.0f} bytes for meshes. An access is one picture: its decodes, at most, of frames "
      "or, of textures, "
      "of frames or nodes for each texture; its milliseconds, on one core.</p>\n",
      report.samples, report.width, report.height, report.raw_bytes, report.inferred_psnr_db, report.geometry_bytes);
  html += Plot(report).svg();
  const Window window = worst_window(report);
  for (size_t target = 0; target < report.series[0].rows.size(); ++target) {
    html += fmt::format("<h2>{:.0f}:1</h2>\n", report.series[0].rows[target].ratio_target);
    html += table(report, target) + close_ups(report, target, window);
  }
  html += "<h2>The whole picture</h2>\n" + figure(report.truth, 1, "ground truth, the sample in the middle");
  write_page(file, html);
}

}  // namespace vitrine
