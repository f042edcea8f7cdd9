// SPDX-License-Identifier: MIT
// libvpl: indirect light on the CPU, the same bits everywhere. Includes all public headers.
#ifndef VPL_VPL_H
#define VPL_VPL_H

#include <vpl/base.h>
#include <vpl/vecmath.h>
#include <vpl/image.h>
#include <vpl/scene.h>
#include <vpl/geometry.h>
#include <vpl/raster.h>
#include <vpl/visibility.h>
#include <vpl/formulas.h>
#include <vpl/lights.h>
#include <vpl/shading.h>
#include <vpl/radiosity.h>
#include <vpl/options.h>
#include <vpl/plan.h>
#include <vpl/render.h>
#include <vpl/pieces.h>

#endif
