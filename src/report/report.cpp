#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "film/image.h"
#include "report/report_assets.h"
#include "report/report_picture.h"
#include "report/report_study.h"

namespace psf::report {
namespace {

// Inside a script element only "<" can end it or open a comment.
std::string json_for_script(const study::Json& json) {
  std::string text;
  for (const char c : core::json_text(json)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string html_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string title(std::span<const Study> studies, const std::string& version) {
  std::vector<std::string> parts;
  for (const Study& study : studies) {
    std::string part = study.dump;
    if (!study.scene.empty()) part = study.scene + " \u2013 " + part;
    if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
  }
  return fmt::format("{} \u00b7 psf {}", fmt::join(parts, ", "), version);
}

// Writes the pictures' script elements; equal pictures share one.
class PictureWriter {
 public:
  explicit PictureWriter(std::ofstream& out) : out_(out) {}

  // What the page must know of them.
  study::Json write(const Study& study, std::size_t count) {
    study::Json pictures = study::Json::array();
    for (std::size_t k = 0; k < count; ++k) {
      core::throw_if_interrupted("no report was written");
      const StudyPicture& picture = study.pictures[k];
      if (!std::filesystem::exists(picture.file)) {
        throw Error(ErrorCode::io, picture.file +
                                       ": no such picture, though the study names it; "
                                       "write the study anew, or `max-pictures 0`");
      }
      const EncodedPicture encoded = encode_picture(film::read_exr(picture.file));
      study::Json entry = {{"id", picture.id},
                           {"point", nullptr},
                           {"payload", payload(encoded.base64)},
                           {"width", encoded.width},
                           {"height", encoded.height}};
      if (picture.has_point) entry["point"] = picture.point;
      pictures.push_back(std::move(entry));
    }
    return pictures;
  }

 private:
  std::size_t payload(const std::string& base64) {
    // The digest has 64 bits: among a million different pictures, two have the same digest with a
    // probability of 3e-8.
    const std::size_t digest = std::hash<std::string>()(base64);
    const auto [found, is_new] = known_.try_emplace(digest, known_.size());
    if (is_new) {
      out_ << "<script type=\"text/plain\" id=\"payload-" << found->second << "\">" << base64
           << "</script>\n";
    }
    return found->second;
  }

  std::ofstream& out_;
  std::map<std::size_t, std::size_t> known_;
};

// The page with each @NAME@ replaced by what its part writes, in the page's order.
void write_page(std::ofstream& out,
                const std::map<std::string_view, std::function<void()>>& parts) {
  std::string_view page = assets::page();
  while (!page.empty()) {
    const std::size_t begin = page.find('@');
    out << page.substr(0, begin);
    if (begin == std::string_view::npos) return;
    const std::size_t end = page.find('@', begin + 1);
    parts.at(page.substr(begin + 1, end - begin - 1))();
    page.remove_prefix(end + 1);
  }
}

}  // namespace

ReportOutcome write_report(std::span<const std::string> folders, const std::string& path,
                           const ReportOptions& options) {
  std::vector<Study> studies;
  for (const std::string& folder : folders) {
    for (Study& study : read_studies(folder)) studies.push_back(std::move(study));
  }
  ReportOutcome outcome;
  outcome.sections = studies.size();

  core::OutputFile file(path);
  std::ofstream out(file.temporary_path(), std::ios::binary);
  study::Json data = {{"version", options.version}, {"sections", study::Json::array()}};
  const auto pictures = [&] {
    PictureWriter writer(out);
    for (const Study& study : studies) {
      const std::size_t count = std::min(options.max_pictures, study.pictures.size());
      const std::size_t left_out = study.pictures.size() - count;
      data["sections"].push_back({{"folder", study.folder},
                                  {"left_out", left_out},
                                  {"pictures", writer.write(study, count)},
                                  {"study", study.json}});
      outcome.pictures += count;
      outcome.pictures_left_out += left_out;
    }
  };
  write_page(out, {{"TITLE", [&] { out << html_escaped(title(studies, options.version)); }},
                   {"STYLE", [&] { out << assets::style(); }},
                   {"PICTURES", pictures},
                   {"DATA", [&] { out << json_for_script(data); }},
                   {"LICENCE", [&] { out << assets::licence(); }},
                   {"D3", [&] { out << assets::d3(); }},
                   {"SCRIPTS", [&] { out << assets::scripts(); }}});
  outcome.bytes = static_cast<std::uint64_t>(out.tellp());
  out.close();
  if (!out) throw Error(ErrorCode::io, path + ": cannot write: " + std::strerror(errno));
  file.commit();
  return outcome;
}

}  // namespace psf::report
