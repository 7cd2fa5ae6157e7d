// What man pages say beyond the help: how a command works, for whoever has no README at hand.
#include <map>

#include "manual/writers.h"

namespace psf::manual {
namespace {

// Names of pages and options are set in bold wherever they stand; a line is a paragraph.
const std::map<std::string, const char*> kProse = {
    {"psf",
     "A renderer writes a record for every light transport path to a path-vertex buffer, a file "
     ".pvb, called a dump. psf averages what each path contributes over nearby vertices of the "
     "same block of paths, with any radius, schedule, block and weights, as often as you like, "
     "without rendering again. It knows no renderer: psf-render(1) writes dumps, and so does any "
     "program that writes the format.\n"
     "Every verb takes --threads, --quiet and --json; the result is the same bytes for any "
     "number of threads. Results go to standard output, progress and notes to standard error. An "
     "error is one line that names the file, the place and the remedy. A file appears under its "
     "name only when it is whole, and an output that is an input or another output is refused "
     "before any work."},
    {"psf-filter",
     "Block by block of paths, what a path contributes becomes the weighted mean over the "
     "vertices of the block within its radius, r0 f / sqrt(n^delta), that every weight lets "
     "pass. The radius shrinks as the samples n accumulate, and the bias with it; f is the size "
     "of a pixel there, the length of the path from the camera, or 1, by the unit of --r0. A "
     "weight takes a threshold, on, or off: --gloss off, --visibility=off. One that is on by "
     "default and whose channel the dump lacks is off, with a note.\n"
     "An .exr holds the picture as R,G,B and, as layers, the same paths without filter, the "
     "number of neighbors, the radius, albedo and normal; every parameter is an attribute. A "
     "dump of several cameras gives a picture for each, with its name before the ending.\n"
     "A sequence of frames, in one dump or in a dump each, gives a picture for each frame where "
     "the "
     "name of the output has #### for its number. With --window K the vertices of K frames are "
     "averaged, of other frames only balls whose mean is within --relit standard errors of the "
     "frame's own, so that what is lit otherwise there has no part; what moves finds itself where "
     "the dump has the channel rest_position."},
    {"psf-info",
     "Only what it needs of the file is read: a dump of any size is opened in milliseconds, also "
     "while it grows, unless --stats asks for every value."},
    {"psf-verify",
     "What is damaged is named by chunk, channel and records. psf-recover(1) saves what is "
     "whole."},
    {"psf-recover",
     "The damaged file is not touched. What was found and what was lost is told a line each. "
     "Where a channel that you can do without is all that is damaged, psf-cat(1) with --drop "
     "keeps every record."},
    {"psf-cat",
     "Dumps of one scene that were rendered apart, with different seeds, become one dump of all "
     "their passes. With one input it is stored otherwise: raw, smaller, fewer channels or "
     "passes. The output may replace one of the inputs."},
    {"psf-export",
     "The name of the output decides: a folder gets a numpy array for each channel, .ply is a "
     "point cloud for MeshLab or CloudCompare, .csv a table.\n"
     "With --for the folder gets the pictures that another denoiser takes, made from the same "
     "paths: "
     "the colours are those of the picture without filter."},
    {"psf-compare",
     "The first five metrics are of linear values; SSIM and FLIP look at the picture as a .png "
     "shows it. Pixels that are not finite are left out and counted, and then no bound holds. "
     "Any program's OpenEXR pictures will do; where several layers could be meant they are "
     "listed."},
    {"psf-flicker",
     "The error of a frame is (x - r) / sqrt(r^2 + epsilon) by pixel and channel. Printed are the "
     "mean of its square over the frames, and the flicker: the variance over the frames of its "
     "change from one frame to the next, averaged over the pixels. Errors that have nothing to do "
     "with each other flicker by twice their variance, an error that stays does not."},
    {"psf-relight",
     "A picture is linear in its lights, also when it is filtered: weights of its layers change "
     "them afterwards, without rendering or filtering again. psf-render(1) writes the layers with "
     "--layers, and psf-filter(1) the picture with them. What it writes can be relit again. "
     "Without weights it says which layers there are, and how much of the light is theirs."},
    {"psf-sweep",
     "A list is values with commas between, or a range: 2px:32px:x2 multiplies, 0.1:0.9:0.1 "
     "adds. Rows that differ in r0 and delta alone share one traversal of the dump. Each row is "
     "what psf-filter(1) and psf-compare(1) give. The folder gets sweep.json and sweep.csv, and "
     "with --pictures every picture; psf-report(1) makes a page of it."},
    {"psf-converge",
     "Dumps of one scene with different seeds are replicates, which tell bias and variance "
     "apart, with intervals of 95%. Local slopes stand beside those of theory. With "
     "--render-json, speed-ups count the time of rendering, of writing the dump and of the "
     "filter. The folder gets the figures; psf-report(1) makes a page of it."},
    {"psf-tune",
     "Independent parts of the passes tell the error of each set of parameters: what one part "
     "gives filtered against what the others give without filter. It says when it is not sure of "
     "its choice. psf-filter(1) with --tuned takes what --json wrote."},
    {"psf-ablate",
     "One part adds the weights that are on one after another, from none to all; one filters the "
     "passes as blocks of one, as two blocks and as one block; one filters the first pass alone, "
     "which is one sample a pixel, one time to eight times. Each row is what psf-filter(1) and "
     "psf-compare(1) give. A sheet shows all pictures with the same exposure, --crop a part of "
     "them, enlarged where it is small. The folder gets ablate.json, ablate.csv and the pictures; "
     "psf-report(1) makes a page of it."},
    {"psf-explain",
     "Lists the pixel's paths, whom they averaged, what each weight refused, and whence its "
     "light came: what each source adds beyond the mean of the pixel's own paths. Where the "
     "difference is more than noise, it names the weight that would have refused the sources "
     "that make it. With --fit linear it shows the weight of each source, with --fireflies which "
     "sources are fireflies, what they keep and what they give."},
    {"psf-report",
     "The page needs no network. It has error maps over any two parameters, errors against n, "
     "tables that sort, and a viewer for the pictures; everything works from the keyboard."},
    {"psf-render",
     "A reference renderer on Embree. A dump is valid after every pass: ^C, --time-limit and "
     "even a kill leave all passes that were finished, and --resume goes on, with the columns of "
     "a render that never stopped. psf-filter(1) with --follow filters a dump while it grows."},
    {"psf-bench",
     "Rows stand beside their targets, and --check makes a target that is missed exit code 1. "
     "Other work on the machine shows in the spread."}};

}  // namespace

std::string prose(const std::string& page) {
  const auto found = kProse.find(page);
  return found == kProse.end() ? "" : found->second;
}

}  // namespace psf::manual
