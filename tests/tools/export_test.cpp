// psf export as a user meets it: arrays, CSV, which records, what goes wrong.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "catch.h"
#include "command.h"
#include "export_sample.h"

namespace fs = std::filesystem;
using namespace psf;
using tests::kPass;
using tests::kRecords;
using tests::Outcome;
using tests::read_text;
using tests::run;
using tests::same_number;
using tests::Sample;
using tests::TempFolder;

namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"') {
      if (quoted && k + 1 < line.size() && line[k + 1] == '"') {
        fields.back() += line[k++];
      } else {
        quoted = !quoted;
      }
    } else if (line[k] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[k];
    }
  }
  return fields;
}

}  // namespace

TEST_CASE("numbers of a CSV give the same values back") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  REQUIRE(run("psf export " + (folder / "in.pvb") + " -o " + (folder / "x.csv")).code == 0);
  std::ifstream in(folder / "x.csv");
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = split(line);
  REQUIRE(names.size() == 2 + 3 * 6 + 5 + 5 + 2);
  CHECK(names[2] == "position_x");
  CHECK(names[5] == "normal_x");
  CHECK(names[8] == "contribution_r");
  CHECK(names[25] == "a,\"b\"_0");
  const auto position = sample.floats("position"), normal = sample.floats("normal");
  const auto contribution = sample.floats("contribution");
  const auto id = sample.stored<std::uint64_t>("id");
  const auto time = sample.stored<double>("time");
  const auto wide = sample.stored<std::uint16_t>("a,\"b\"");
  std::size_t row = 0, wrong = 0;
  for (; std::getline(in, line); ++row) {
    const std::vector<std::string> fields = split(line);
    REQUIRE(fields.size() == names.size());
    REQUIRE(row < kRecords);
    wrong += fields[0] != std::to_string(row) || fields[1] != std::to_string(row / kPass);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto value = [&](std::size_t k) { return std::strtof(fields[k + c].c_str(), nullptr); };
      wrong += !same_number(value(2), position[3 * row + c]);
      wrong += !same_number(value(5), normal[3 * row + c]);
      wrong += !same_number(value(8), contribution[3 * row + c]);
    }
    wrong += std::strtoull(fields[23].c_str(), nullptr, 10) != id[row];
    const double t = std::strtod(fields[24].c_str(), nullptr);
    wrong += !(t == time[row] || (std::isnan(t) && std::isnan(time[row])));
    for (std::size_t c = 0; c < 5; ++c)
      wrong += fields[25 + c] != std::to_string(wide[5 * row + c]);
  }
  CHECK(row == kRecords);
  CHECK(wrong == 0);
}

TEST_CASE("passes and every choose the records") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  const auto id = sample.stored<std::uint64_t>("id");
  struct Choice {
    std::string options;
    std::size_t first, last, every;
  };
  for (const Choice& choice : {Choice{"--passes 1:2", kPass, 2 * kPass, 1},
                               Choice{"--passes 1: --every 7", kPass, kRecords, 7},
                               Choice{"--passes :1 --every 699", 0, kPass, 699},
                               Choice{"--every 5000", 0, kRecords, 5000}}) {
    CAPTURE(choice.options);
    REQUIRE(run("psf export " + (folder / "in.pvb") + " -o " + (folder / "x.csv") +
                " --channels id " + choice.options)
                .code == 0);
    std::string expected = "record,pass,id\n";
    for (std::size_t k = choice.first; k < choice.last; k += choice.every) {
      expected += fmt::format("{},{},{}\n", k, k / kPass, id[k]);
    }
    const bool same = read_text(folder / "x.csv") == expected;
    CHECK(same);
  }
}

TEST_CASE("arrays have the header and the bytes that numpy wants") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  const fs::path out = folder.path() / "arrays";
  REQUIRE(run("psf export " + (folder / "in.pvb") + " -o " + out.string() + "/").code == 0);
  struct Expected {
    std::string file, descr, shape;
  };
  for (const Expected& expected :
       {Expected{"position", "<f4", "(2100, 3)"}, Expected{"normal", "<f4", "(2100, 3)"},
        Expected{"contribution", "<f2", "(2100, 3)"}, Expected{"flags", "|u1", "(2100,)"},
        Expected{"id", "<u8", "(2100,)"}, Expected{"time", "<f8", "(2100,)"},
        Expected{"a__b_", "<u2", "(2100, 5)"}, Expected{"_._x", "|u1", "(2100,)"},
        Expected{"_._x_2", "|u1", "(2100,)"}, Expected{"pass", "<u4", "(2100,)"}}) {
    CAPTURE(expected.file);
    const std::string text = read_text((out / (expected.file + ".npy")).string());
    REQUIRE(text.size() > 64);
    CHECK(text.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t length =
        static_cast<unsigned char>(text[8]) + 256u * static_cast<unsigned char>(text[9]) + 10;
    CHECK(length % 64 == 0);
    CHECK(text[length - 1] == '\n');
    CHECK(text.find("{'descr': '" + expected.descr +
                    "', 'fortran_order': False, 'shape': " + expected.shape + ", }") == 10);
  }
  const auto normal = sample.floats("normal");
  const std::string stored = read_text((out / "normal.npy").string());
  CHECK(stored.substr(stored.size() - 4 * normal.size()) ==
        std::string(reinterpret_cast<const char*>(normal.data()), 4 * normal.size()));
  CHECK(read_text((out / "metadata.json").string()) == R"({"scene":"sample"})");
  CHECK(std::distance(fs::directory_iterator(out), fs::directory_iterator()) == 16);
  CHECK(fs::exists(folder.path() / "x") == false);
}

TEST_CASE("numpy loads the arrays and finds the values that pvb.py finds") {
  if (std::system("/usr/bin/python3 -c 'import numpy, zstandard' 2>/dev/null") != 0) {
    SKIP("Debian's python3 has no numpy or no zstandard");
  }
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  REQUIRE(run("psf export " + (folder / "in.pvb") + " -o " + (folder / "arrays")).code == 0);
  std::ofstream(folder / "check.py")
      << "import sys, numpy as np\n"
         "sys.dont_write_bytecode = True\n"
         "sys.path.insert(0, sys.argv[1]); import pvb\n"
         "f = pvb.open(sys.argv[2]); n = 0\n"
         "for name in list(f.channels)[:11]:\n"
         "    a, b = np.load(f'{sys.argv[3]}/{name}.npy', allow_pickle=False), f[name]\n"
         "    assert a.dtype == b.dtype and a.shape == b.shape, name\n"
         "    assert a.tobytes() == b.tobytes(), name\n"
         "    n += 1\n"
         "assert (np.load(sys.argv[3] + '/pass.npy') == f.pass_index()).all()\n"
         "print(n)\n";
  const Outcome outcome =
      run("/usr/bin/python3 " + (folder / "check.py") + " " PSF_SOURCE_DIR "/formats " +
          (folder / "in.pvb") + " " + (folder / "arrays"));
  INFO(outcome.err);
  CHECK(outcome.out == "11\n");
}

TEST_CASE("the same bytes for any number of threads") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  for (const std::string name : {"x.ply", "x.csv"}) {
    std::array<std::string, 2> texts;
    for (std::size_t k = 0; k < 2; ++k) {
      REQUIRE(run("psf export " + (folder / "in.pvb") + " -o " + (folder / name) + " --threads " +
                  (k == 0 ? "1" : "3"))
                  .code == 0);
      texts[k] = read_text(folder / name);
    }
    const bool same = texts[0] == texts[1];
    CHECK(same);
  }
}

TEST_CASE("every mistake in an export is one line, has its exit code and leaves nothing behind") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  std::ofstream(folder / "file") << "a file";
  fs::create_directory(folder.path() / "full");
  std::ofstream(folder / "full/mine.npy") << "mine";
  std::ofstream(folder / "text.pvb") << "no dump";
  std::ofstream(folder / "old.ply") << "old";
  const std::size_t files = folder.file_count();
  struct Mistake {
    std::string arguments;
    int code;
    std::string message;
  };
  const std::string in = folder / "in.pvb", to = " -o " + folder.path().string() + "/";
  for (const Mistake& mistake : std::vector<Mistake>{
           {in, 2, "--output is required"},
           {in + to + "x.obj", 2, "unknown format .obj; end the name in .ply or .csv"},
           {in + to + "x.npy", 2, "give a folder for .npy arrays"},
           {in + to + "x.ply --format obj", 2, "--format"},
           {in + to + "x.csv --colour normal", 2, "for point clouds (.ply) alone"},
           {in + to + "x.ply --exposure bright", 2, "'bright' is neither auto nor a number"},
           {in + to + "x.ply --every 0", 2, "--every"},
           {in + to + "x --for optix", 2, "--for: optix not in {oidn,nfor,bcd}"},
           {in + to + "x --for oidn --format npy", 2, "--format has no meaning beside --for oidn"},
           {in + to + "x --for nfor --channels normal", 2, "--channels has no meaning beside"},
           {in + to + "x --for bcd --table paths", 2, "--table has no meaning beside --for bcd"},
           {in + to + "x --for bcd --every 1", 2, "--every has no meaning beside --for bcd"},
           {in + to + "x --for bcd --color normal", 2, "--colour has no meaning beside --for bcd"},
           {in + to + "x --for bcd --exposure auto", 2, "--exposure has no meaning beside --for"},
           {in + to + "x --for nfor", 3, "the metadata name no camera; a picture needs its size"},
           {in + to + "x.ply --passes 2", 2, "write FIRST:LAST"},
           {in + to + "x.ply --passes 2:4", 2, "has passes 0:3, 2:4 is no part of them"},
           {in + to + "x.csv --channels flags,colour", 3, "has no channel colour; it has position"},
           {in + to + "old.ply --colour colour", 3, "has no channel colour"},
           {in + to + "old.ply --colour 'a,\"b\"'", 3, "no colour can be made of the channel a"},
           {in + to + "file", 4, "is a file, and the arrays need a folder"},
           {in + to + "full", 4, "is a folder with something in it"},
           {in + to + "nowhere/arrays", 4, "does not exist, create it first"},
           {in + to + "nowhere/x.csv", 4, "does not exist, create it first"},
           {in + to + "full --format csv", 4, "is a folder, a file name is needed"},
           {in + " --format csv -o /dev/full", 4, "/dev/full: cannot write: No space left"},
           {in + " --format ply -o /dev/full", 4, "/dev/full: cannot write: No space left"},
           {folder / "text.pvb" + to + "arrays", 3, "is no path-vertex buffer"},
           {folder / "none.pvb" + to + "arrays", 4, "none.pvb: "}}) {
    const Outcome outcome = run("psf export " + mistake.arguments);
    INFO(mistake.arguments << "\n" << outcome.err);
    CHECK(outcome.code == mistake.code);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.err.find(mistake.message) != std::string::npos);
    CHECK(outcome.out.empty());
    CHECK(folder.file_count() == files);
  }
  CHECK(read_text(folder / "old.ply") == "old");
  CHECK(read_text(folder / "full/mine.npy") == "mine");
  CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("an export that runs out of space keeps what was there before") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  std::ofstream(folder / "x.csv") << "old";
  const std::size_t files = folder.file_count();
  for (const std::string name : {"x.csv", "arrays"}) {
    const Outcome outcome = run("sh -c 'trap \"\" XFSZ; ulimit -f 10; psf export " +
                                (folder / "in.pvb") + " -o " + (folder / name) + "'");
    INFO(outcome.err);
    CHECK(outcome.code == 4);
    CHECK(outcome.err.find("free some space") != std::string::npos);
    CHECK(folder.file_count() == files);
  }
  CHECK(read_text(folder / "x.csv") == "old");
}
