// psf compare: the error of pictures against a reference.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli.h"
#include "core/output_file.h"
#include "film/image.h"
#include "formats/error.h"
#include "study/metrics.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct CompareOptions {
  std::string picture, reference;
  std::string layer;  // prefix of the channels in the picture, "unfiltered-input."
  std::string metric = "relmse";
  double max = -1;  // negative: no limit
  CommonOptions common;
};

void run(const CompareOptions& options) {
  const film::Image picture = film::read_exr(options.picture);
  const film::Image reference = film::read_exr(options.reference);
  if (picture.width != reference.width || picture.height != reference.height) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: is {}x{}, but {} is {}x{}; compare pictures of one size",
                            options.picture, picture.width, picture.height, options.reference,
                            reference.width, reference.height));
  }
  const std::string prefix = options.layer.empty() ? "" : options.layer + ".";
  const study::Metrics metrics = study::compare(picture.rgb(prefix), reference.rgb());
  fmt::print("relMSE {:.6g}  (epsilon {:g})\nMSE    {:.6g}\nPSNR   {:.2f} dB\n", metrics.rel_mse,
             study::kRelMseEpsilon, metrics.mse, metrics.psnr);
  if (!options.common.json.empty()) {
    const nlohmann::ordered_json figures = {
        {"picture", options.picture}, {"reference", options.reference},
        {"relmse", metrics.rel_mse},  {"relmse_epsilon", study::kRelMseEpsilon},
        {"mse", metrics.mse},         {"psnr", metrics.psnr}};
    core::write_text_file(options.common.json, figures.dump(2) + "\n");
  }
  const double value = options.metric == "mse" ? metrics.mse : metrics.rel_mse;
  // Written so that a not-a-number fails too.
  if (options.max >= 0 && !(value <= options.max)) {
    throw Error(ErrorCode::comparison, fmt::format("{}: {} {:.6g} is above {:g}", options.picture,
                                                   options.metric, value, options.max));
  }
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      app.add_subcommand("compare", "print the error of a picture against a reference");
  command->add_option("PICTURE", options->picture, "EXR picture")->required();
  command->add_option("REFERENCE", options->reference, "EXR picture taken as the truth")
      ->required();
  command
      ->add_option("--layer", options->layer,
                   "compare this layer of PICTURE, for example unfiltered-input")
      ->type_name("NAME");
  command->add_option("--metric", options->metric, "the metric that --max looks at")
      ->check(CLI::IsMember({"relmse", "mse"}))
      ->capture_default_str();
  command->add_option("--max", options->max, "exit with 1 where the metric is above this")
      ->check(CLI::NonNegativeNumber);
  add_common(*command, options->common);
  set_example(*command, "psf compare filtered.exr reference.exr --max 0.01");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
