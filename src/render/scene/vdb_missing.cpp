// What a program that was built without OpenVDB says of grids.
#include "core/error.h"
#include "render/scene/vdb.h"

namespace psf::render {

std::shared_ptr<const DensityGrid> read_vdb(const std::string& path, const std::string&,
                                            const Imath::M44d&) {
  throw Error(ErrorCode::bad_input, path +
                                        ": grids are read by OpenVDB, which this program was "
                                        "built without; build it with -DPSF_BUILD_VDB=ON");
}

}  // namespace psf::render
