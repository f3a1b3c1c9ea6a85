// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/view_text.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display {
namespace {

constexpr std::array kRegular{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                              "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                              "/usr/share/fonts/TTF/DejaVuSans.ttf"};
constexpr std::array kBold{"/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
                           "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans-Bold.ttf",
                           "/usr/share/fonts/TTF/DejaVuSans-Bold.ttf"};
constexpr double kUnits_px = 64.0;  // FreeType counts 1/64 px

// Code points; a byte that begins or continues nothing is U+FFFD.
std::vector<std::uint32_t> code_points(const std::string& text) {
  constexpr std::uint32_t kReplacement = 0xFFFD;
  std::vector<std::uint32_t> all;
  for (std::size_t at = 0; at < text.size();) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t length = lead < 0x80             ? 1
                               : (lead & 0xE0) == 0xC0 ? 2
                               : (lead & 0xF0) == 0xE0 ? 3
                               : (lead & 0xF8) == 0xF0 ? 4
                                                       : 0;
    std::uint32_t code = length == 1 ? lead : lead & (0x7Fu >> length);
    bool whole = length > 0 && at + length <= text.size();
    for (std::size_t i = 1; whole && i < length; ++i) {
      const auto next = static_cast<unsigned char>(text[at + i]);
      whole = (next & 0xC0) == 0x80;
      code = (code << 6) | (next & 0x3Fu);
    }
    all.push_back(whole ? code : kReplacement);
    at += whole ? length : 1;
  }
  return all;
}

template <std::size_t N>
FT_Face open_face(FT_Library library, const std::array<const char*, N>& files) {
  for (const char* file : files) {
    FT_Face face = nullptr;
    if (FT_New_Face(library, file, 0, &face) == 0) return face;
  }
  throw ConfigError("display.view.font", "no " + std::string(files.front()),
                    "the fonts DejaVu Sans (Debian: fonts-dejavu-core)");
}

void blend(cv::Mat& image, const FT_Bitmap& glyph, int left, int top, double grey) {
  for (int y = 0; y < static_cast<int>(glyph.rows); ++y) {
    const int row = top + y;
    if (row < 0 || row >= image.rows) continue;
    for (int x = 0; x < static_cast<int>(glyph.width); ++x) {
      const int column = left + x;
      if (column < 0 || column >= image.cols) continue;
      const double share = glyph.buffer[y * glyph.pitch + x] / 255.0;
      auto& pixel = image.at<cv::Vec3b>(row, column);
      for (int channel = 0; channel < 3; ++channel) {
        pixel[channel] = static_cast<unsigned char>(
            std::lround(pixel[channel] + share * (grey - pixel[channel])));
      }
    }
  }
}

}  // namespace

struct Typeface::Faces {
  FT_Library library = nullptr;
  FT_Face regular = nullptr;
  FT_Face bold = nullptr;

  ~Faces() { FT_Done_FreeType(library); }  // with its faces

  /// Calls use(face, whole column of the pen) with each glyph loaded, shifted by the rest.
  /// @param column  where the pen begins [px]
  /// @return length [px]
  template <typename Use>
  double walk(const std::string& text, double column, double em_px, bool is_bold, FT_Int32 how,
              Use use) {
    FT_Face face = is_bold ? bold : regular;
    const double bounded_px = std::clamp(em_px, 1.0, 2000.0);
    FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(bounded_px * kUnits_px)), 72, 72);
    double pen_px = 0.0;
    FT_UInt before = 0;
    for (const std::uint32_t code : code_points(text)) {
      const FT_UInt glyph = FT_Get_Char_Index(face, code);
      FT_Vector kerning{};
      if (before != 0) FT_Get_Kerning(face, before, glyph, FT_KERNING_UNFITTED, &kerning);
      before = glyph;
      pen_px += static_cast<double>(kerning.x) / kUnits_px;
      const double whole = std::floor(column + pen_px);
      FT_Vector rest{std::lround((column + pen_px - whole) * kUnits_px), 0};
      FT_Set_Transform(face, nullptr, &rest);
      if (FT_Load_Glyph(face, glyph, how | static_cast<FT_Int32>(FT_LOAD_NO_HINTING)) != 0)
        continue;
      use(face, static_cast<int>(whole));
      pen_px += static_cast<double>(face->glyph->advance.x) / kUnits_px;
    }
    return pen_px;
  }
};

Typeface::Typeface() : faces_(std::make_unique<Faces>()) {
  if (FT_Init_FreeType(&faces_->library) != 0) {
    throw ConfigError("display.view.font", "no FreeType", "memory for it");
  }
  faces_->regular = open_face(faces_->library, kRegular);
  faces_->bold = open_face(faces_->library, kBold);
}

Typeface::~Typeface() = default;

double Typeface::width(const std::string& text, double em_px, bool bold) {
  return faces_->walk(text, 0.0, em_px, bold, FT_LOAD_DEFAULT, [](FT_Face, int) {});
}

void Typeface::write(cv::Mat& image, const std::string& text, double column, double row,
                     double em_px, bool bold, double grey) {
  faces_->walk(text, column, em_px, bold, FT_LOAD_RENDER, [&](FT_Face face, int pen) {
    const FT_GlyphSlot slot = face->glyph;
    blend(image, slot->bitmap, pen + slot->bitmap_left,
          static_cast<int>(std::lround(row)) - slot->bitmap_top, grey);
  });
}

}  // namespace stillhand::display
