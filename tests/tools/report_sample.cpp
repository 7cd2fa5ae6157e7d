// Writes the folders of report_sample.h for the test of the page in a browser.
#include "report_sample.h"

// What a page that parses what it shows would run.
constexpr const char* kHostile =
    "</script><script>window.hacked = 1</script><img src=x onerror='window.hacked = 1'>&amp;.json";

int main(int, char** argv) {
  const std::string folder = argv[1];
  psf::tests::write_sample(folder + "/radii", psf::tests::sample_sweep(kHostile));
  psf::tests::write_sample(folder + "/rates", psf::tests::sample_converge("room.json"));
  psf::tests::write_sample(folder + "/parts", psf::tests::sample_ablate("room.json"));
  return 0;
}
