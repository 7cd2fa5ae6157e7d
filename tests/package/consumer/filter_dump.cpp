// Filters a dump: filter_dump IN.pvb OUT.exr
#include <psf/psf.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    const psf::Dump dump(argv[1]);
    dump.filter(psf::Parameters().set("r0", "12px")).pictures[0].save(argv[2]);
  } catch (const psf::Error& error) {
    std::cerr << "filter_dump: " << error.what() << '\n';
    return static_cast<int>(error.code());
  }
}
