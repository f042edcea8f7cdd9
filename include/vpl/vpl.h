// SPDX-License-Identifier: MIT
// libvpl: indirect light on the CPU, the same bits everywhere. A program that renders needs this header only: it declares
// contexts, scenes, options, pictures, plans and renders. <vpl/stages.h> declares every stage by itself.
#ifndef VPL_VPL_H
#define VPL_VPL_H

#include <vpl/base.h>
#include <vpl/vecmath.h>
#include <vpl/image.h>
#include <vpl/scene.h>
#include <vpl/options.h>
#include <vpl/plan.h>
#include <vpl/render.h>

#endif
