// Owners of the objects of Cairo.
#pragma once

#include <cairo.h>

#include <memory>

namespace pleat {

struct CairoDestroyer {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDestroyer>;
using CairoContext = std::unique_ptr<cairo_t, CairoDestroyer>;

}  // namespace pleat
