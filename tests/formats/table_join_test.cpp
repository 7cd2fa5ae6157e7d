// Which files with tables psf cat joins, and how it names what keeps it from that.
#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/write/concatenate.h"
#include "tabled.h"

using namespace psf;
using namespace psf::formats;

namespace {

// Two files of two passes, the second of another head.
class TwoTabled {
 public:
  explicit TwoTabled(const Head& other) {
    test::write_tabled_file(first_, Codec::raw, 2);
    Writer writer(second_, other, {Codec::raw, false, {}});
    const std::vector<std::byte> zeros(1000);
    const std::vector<const void*> columns(20, zeros.data());
    writer.append(1, std::span(columns).first(other.channels.size()));
    for (std::size_t k = 1; k < other.table_count(); ++k) {
      writer.append_to(k, 9, std::span(columns).first(other.schema(k).channels.size()));
    }
    writer.commit();
    writer.close();
  }
  // What is said where they are not joined.
  [[nodiscard]] std::string refusal(const ConcatenateOptions& options = {}) const {
    try {
      static_cast<void>(concatenate(std::vector{first_, second_}, out(), options));
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::bad_input);
      return error.what();
    }
    return "";
  }
  [[nodiscard]] std::string out() const { return scratch_.path("out.pvb"); }

 private:
  test::Scratch scratch_;
  std::string first_ = scratch_.path("first.pvb"), second_ = scratch_.path("second.pvb");
};

}  // namespace

TEST_CASE("tables whose chunks are of other sizes are joined, with the larger ones") {
  Head other = test::tabled_head();
  other.tables[0].chunk_capacity = 5;
  other.tables[1].chunk_capacity = 40;
  const TwoTabled two(other);
  CHECK(two.refusal().empty());
  const Reader joined(two.out());
  CHECK(joined.head().tables[0].chunk_capacity == test::tabled_head().tables[0].chunk_capacity);
  CHECK(joined.head().tables[1].chunk_capacity == 40);
  CHECK(joined.table(1).records() == 31 + 32 + 9);
  CHECK(joined.table(2).records() == 0 + 9 + 9);
  CHECK(check(two.out()).faults.empty());
}

TEST_CASE("the first difference of tables is named, and nothing else") {
  const auto refusal = [](const auto& change) {
    Head other = test::tabled_head();
    change(other);
    const std::string text = TwoTabled(other).refusal();
    return text.substr(text.find("first.pvb: ") + 11);
  };
  const std::string remedy = "; 'psf cat --drop' leaves tables out";
  CHECK(refusal([](Head& h) { h.tables.pop_back(); }) == "it has no table rare" + remedy);
  CHECK(refusal([](Head& h) {
          h.tables.push_back(h.tables[1]);
          h.tables[2].name = "more";
        }) == "it has a table more, which the other has not" + remedy);
  CHECK(refusal([](Head& h) { h.tables[1].name = "other"; }) ==
        "it has a table other, not rare" + remedy);
  CHECK(refusal([](Head& h) { h.tables[0].channels[2].components = 2; }) ==
        "its table marks has other channels: as number 2 value f32 x 2, not value f32 x 3" +
            remedy);
  CHECK(refusal([](Head& h) { h.tables[0].channels.pop_back(); }) ==
        "its table marks has other channels: as number 3 none, not depth u16 x 1" + remedy);
}

TEST_CASE("a name that is neither channel nor table is told with both") {
  const TwoTabled two(test::tabled_head());
  ConcatenateOptions options;
  options.drop = {"marks.value"};
  const std::string text = two.refusal(options);
  CHECK(test::has(text, "has no channel or table marks.value; it has number, "));
  CHECK(test::has(text, ", and the tables marks, rare"));
}
