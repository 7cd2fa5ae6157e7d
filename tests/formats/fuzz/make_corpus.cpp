// Makes the seeds of the corpus: small files of every kind, whole and damaged, and parts of them.
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "file_bytes.h"
#include "formats/layout/codec.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/metadata.h"
#include "formats/layout/quantize.h"
#include "formats/write/writer.h"
#include "golden.h"

namespace psf::fuzz {
namespace {

using formats::Codec;
using formats::Type;
using test::Bytes;

formats::Head small_head() {
  formats::Head head;
  head.chunk_capacity = 4;
  head.channels = {{"position", Type::f32, 3},
                   {"normal", Type::u16, 2, formats::Encoding::octahedral},
                   {"reflectance", Type::f16, 3},
                   {"flags", Type::u8, 1},
                   {"time", Type::f64, 1}};
  head.metadata = R"({"producer":"seed","cameras":[{"name":"main","width":3,"height":2}]})";
  return head;
}

// Two passes of six records; zeros where zstd should have something to win.
void append(formats::Writer& writer, std::size_t count, Codec codec) {
  const std::array<std::size_t, 5> strides = {12, 4, 6, 1, 8};
  std::array<Bytes, 5> columns;
  std::array<const void*, 5> pointers{};
  for (std::size_t k = 0; k < columns.size(); ++k) {
    for (std::size_t byte = 0; byte < count * strides[k]; ++byte) {
      columns[k].push_back(static_cast<std::byte>(codec == Codec::zstd ? 0 : 16 * k + byte));
    }
    pointers[k] = columns[k].data();
  }
  writer.append(count, pointers);
}

Bytes make_file(const test::Scratch& scratch, Codec codec, std::size_t passes, bool close) {
  const std::string path = scratch.path("seed.pvb");
  formats::Head head = small_head();
  if (codec == Codec::zstd) head.chunk_capacity = 256;
  formats::Writer writer(path, head, {codec, false, test::golden_uuid()});
  for (std::size_t pass = 0; pass < passes; ++pass) {
    append(writer, codec == Codec::zstd ? 256 : 6, codec);
    const std::string resume = "pass " + std::to_string(pass);
    writer.commit(std::as_bytes(std::span(resume)));
  }
  if (close) {
    writer.close();
  } else {
    append(writer, 4, Codec::raw);  // a whole chunk behind the last commit
  }
  return test::load(path);
}

formats::Head small_tables() {
  formats::Head head = small_head();
  formats::Table some, rare;
  some.name = "some";
  some.chunk_capacity = 3;
  some.channels = {{"number", Type::u32, 1}, {"place", Type::f32, 3}};
  rare.name = "rare";
  rare.chunk_capacity = 2;
  rare.channels = {{"number", Type::u64, 1}};
  head.tables = {some, rare};
  return head;
}

// Three passes of four paths; of the second table the second alone has records.
void append_tables(formats::Writer& writer, Codec codec) {
  const std::array<std::uint32_t, 15> words{1, 2, 3, 4, 5};
  for (std::size_t pass = 0; pass < 3; ++pass) {
    append(writer, 4, codec);
    const std::array<const void*, 2> some = {words.data(), words.data()};
    writer.append_to(1, 5, some);
    const std::array<const void*, 1> rare = {words.data()};
    writer.append_to(2, pass == 1 ? 3 : 0, rare);
    writer.commit();
  }
}

// A frame that version 1 does not know, and a commit behind it.
Bytes with_unknown_frame(const Bytes& file, std::uint32_t flags) {
  Bytes out = file;
  const auto last = test::frames(file).back();
  const auto begin = file.begin() + static_cast<std::ptrdiff_t>(last.offset);
  const Bytes commit(begin, begin + static_cast<std::ptrdiff_t>(last.length));
  const std::size_t unknown = out.size();
  out.insert(out.end(), commit.begin(), commit.begin() + 4096);
  test::put(out, unknown + 24, 4, 0x5458454E);  // NEXT
  test::put(out, unknown + 28, 4, flags);
  const std::size_t again = out.size();
  out.insert(out.end(), commit.begin(), commit.end());
  test::put(out, again + 64 + 8, 8, test::get(file, last.offset + 64 + 8, 8) + 1);
  test::put(out, again + 64 + 40, 8, last.offset);
  for (const std::size_t frame : {unknown, again}) {
    test::put(out, frame + 32, 8, frame);
    test::put(out, frame + 48, 8, test::get(out, last.offset + 48, 8) + (frame == again ? 2 : 1));
    test::mend(out, frame);
  }
  return out;
}

Bytes with_bit_flipped(Bytes file, const std::string& type, std::size_t place) {
  file.at(test::frames(file, type).at(0).offset + place) ^= std::byte{4};
  return file;
}

void save_files(const std::string& folder) {
  const test::Scratch scratch;
  const Bytes raw = make_file(scratch, Codec::raw, 2, true);
  const std::string open = folder + "/open/", recover = folder + "/recover/";
  test::save(open + "closed.pvb", raw);
  test::save(open + "zstd.pvb", make_file(scratch, Codec::zstd, 2, true));
  test::save(open + "tail.pvb", make_file(scratch, Codec::raw, 1, false));
  test::save(open + "unknown-frame.pvb", with_unknown_frame(raw, 0));
  test::save(open + "unknown-required-frame.pvb", with_unknown_frame(raw, 1));
  test::save(open + "slot-lost.pvb", with_bit_flipped(raw, "SLOT", 60));
  test::save(recover + "head-lost.pvb", with_bit_flipped(raw, "HEAD", 80));
  test::save(recover + "column-lost.pvb", with_bit_flipped(raw, "CHNK", 256));
  test::save(recover + "chunk-lost.pvb", with_bit_flipped(raw, "CHNK", 40));
  test::save(recover + "commit-lost.pvb", with_bit_flipped(raw, "CMIT", 70));
  test::save(recover + "index-lost.pvb", with_bit_flipped(raw, "CMIT", 260));
  test::save(recover + "cut.pvb", Bytes(raw.begin(), raw.end() - 6000));
  const std::string path = scratch.path("tables.pvb");
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    formats::Writer writer(path, small_tables(), {codec, false, test::golden_uuid()});
    append_tables(writer, codec);
    writer.close();
    const Bytes tables = test::load(path);
    test::save(open + (codec == Codec::raw ? "tables.pvb" : "tables-zstd.pvb"), tables);
    if (codec == Codec::zstd) continue;
    test::save(recover + "table-lost.pvb", with_bit_flipped(tables, "TCHK", 40));
    test::save(recover + "table-column-lost.pvb", with_bit_flipped(tables, "TCHK", 200));
    test::save(recover + "table-commit-lost.pvb", with_bit_flipped(tables, "CMIT", 240));
  }
}

Bytes marked(char mark, std::span<const std::byte> bytes) {
  Bytes out{static_cast<std::byte>(mark)};
  out.insert(out.end(), bytes.begin(), bytes.end());
  return out;
}

Bytes stored(std::byte what, std::size_t size, std::span<const std::byte> bytes) {
  Bytes out{what, static_cast<std::byte>(size & 0xFF), static_cast<std::byte>(size >> 8)};
  out.insert(out.end(), bytes.begin(), bytes.end());
  return out;
}

void save_columns(const std::string& folder) {
  const std::string decode = folder + "/decode/";
  const Bytes values = test::golden_values(0, 0, 48);
  formats::Buffer storage;
  const Bytes zeros(5000);
  for (const Bytes& raw : {zeros, Bytes(values.begin(), values.begin() + 240)}) {
    const auto encoded = formats::encode_column(Codec::zstd, raw, storage);
    const std::string name = raw.size() == 240 ? "values" : "zeros";
    test::save(decode + name + "-zstd", stored(std::byte{0}, raw.size(), encoded.bytes));
    test::save(decode + name + "-shuffled", stored(std::byte{1}, raw.size(), encoded.bytes));
  }
  test::save(decode + "shuffle", stored(std::byte{2}, 0, std::span(values).first(63)));
  test::save(decode + "octahedral", stored(std::byte{3}, 0, std::span(values).first(120)));
  test::save(decode + "half", stored(std::byte{4}, 0, std::span(values).first(120)));
}

void save_metadata(const std::string& folder) {
  const test::Scratch scratch;
  const std::string metadata = folder + "/metadata/";
  const std::string json = test::golden_head().metadata;
  test::save(metadata + "golden.json", marked(' ', std::as_bytes(std::span(json))));
  const std::string wrong = R"({"seed":-1,"lights":[1],"cameras":{}})";
  test::save(metadata + "wrong-types.json", marked(' ', std::as_bytes(std::span(wrong))));
  test::save(metadata + "head", marked('h', formats::encode_head(small_head())));
  const Bytes file = make_file(scratch, Codec::raw, 1, true);
  // A file with the two channels that the target expects.
  const Bytes golden_two = [&] {
    test::write_example(scratch.path("example.pvb"));
    return test::load(scratch.path("example.pvb"));
  }();
  const auto directory = [](const Bytes& bytes, const std::string& type) {
    const std::size_t frame = test::frames(bytes, type).at(0).offset;
    return std::span(bytes).subspan(frame + 64, test::get(bytes, frame + 56, 4));
  };
  test::save(metadata + "chunk", marked('c', directory(golden_two, "CHNK")));
  test::save(metadata + "commit", marked('m', directory(file, "CMIT")));
  const std::size_t commit = test::frames(file, "CMIT").at(0).offset;
  test::save(metadata + "index", marked('i', std::span(file).subspan(commit + 256, 64)));
  const std::size_t slot = test::frames(file, "SLOT").at(0).offset;
  test::save(metadata + "slot", marked('i', std::span(file).subspan(slot + 1024, 32)));
}

}  // namespace
}  // namespace psf::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "psf_make_corpus: give the folder to write to, tests/formats/fuzz/corpus\n");
    return 2;
  }
  try {
    const std::string folder = argv[1];
    for (const char* target : {"open", "recover", "decode", "metadata"}) {
      std::filesystem::create_directories(folder + "/" + target);
    }
    psf::fuzz::save_files(folder);
    psf::fuzz::save_columns(folder);
    psf::fuzz::save_metadata(folder);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "psf_make_corpus: %s\n", error.what());
    return 4;
  }
}
