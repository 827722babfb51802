// stb_image_write is a private copy (STATIC), because Debian also ships a compiled libstb.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include "pleat/render/image.h"

namespace pleat {

std::string EncodePng(const Image& image) {
  static_assert(sizeof(Rgb) == 3);
  std::string bytes;
  const auto append = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), size);
  };
  stbi_write_png_to_func(append, &bytes, image.width(), image.height(), 3, image.pixels().data(),
                         3 * image.width());
  return bytes;
}

}  // namespace pleat
