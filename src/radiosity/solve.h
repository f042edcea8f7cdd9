// SPDX-License-Identifier: MIT
// Light that sides exchange, as solvers need it: F times radiosities, by rows of form factors or by links.
#ifndef VPL_RADIOSITY_SOLVE_H
#define VPL_RADIOSITY_SOLVE_H

#include <vpl/radiosity.h>

enum { VPL_SIDE_LANES = 16 };

// One value per side, channel by channel; up to a multiple of VPL_SIDE_LANES, the last are 0.
typedef struct vplPlanes {
    float* c[3];
} vplPlanes;

size_t vplPaddedSides(int count);
vplResult vplPlanes_Create(vplContext* context, int count, vplPlanes* planesOut); // all 0
void vplPlanes_Destroy(vplContext* context, vplPlanes* planes);
void vplPlanes_Read(vplPlanes* planes, const vplRgb* values, int count);
void vplPlanes_Write(const vplPlanes* planes, int count, vplRgb* valuesOut);

// ---- kernels (solve_kernel.c)

// The sums of row[j] times planes[c][j].
typedef void vplRowDotFcn(const float* row, const vplPlanes* planes, int count, double sumOut[3]);

// One shot of progressive radiosity.
typedef struct vplShot {
    const float* row; // form factors from the side that shoots
    float power[3];   // that it shoots, W
    vplPlanes gain;   // reflectance / area, 1/m^2
    vplPlanes unshot;
    const float* area;
} vplShot;

// Hands it out; returns the side whose unshot power, the sum of the channels' magnitudes, is largest now: of equal
// ones the first, -1 where none has any.
typedef int vplShootFcn(const vplShot* shot, int count);

vplRowDotFcn* vplGetRowDot(vplIsa isa);
vplShootFcn* vplGetShoot(vplIsa isa);

// ---- the exchange (solve_exchange.c)

typedef struct vplExchange {
    const vplTransport* transport;
    vplContext* context;
    int count;
    vplPlanes reflectance;
    double (*sums)[3]; // of the last vplExchange_Gather
    double* nodes;     // links: scratch
} vplExchange;

// Rows in a task.
enum { VPL_EXCHANGE_ROWS = 16 };

vplResult vplExchange_Create(const vplTransport* transport, vplExchange* exchangeOut);
void vplExchange_Destroy(vplExchange* exchange);

// sums = F x, all sides or, of form factors, those in [first, end).
void vplExchange_Gather(vplExchange* exchange, const vplPlanes* x);
void vplExchange_GatherRows(vplExchange* exchange, const vplPlanes* x, int first, int end);

// Fills spectralRadius and the rows' sums. `x` is scratch.
void vplFindSpectrum(vplExchange* exchange, vplPlanes* x, vplSolveStats* stats);

// ---- solvers (solve_sweep.c)

typedef struct vplSolve {
    vplExchange exchange;
    const vplSolveDef* def;
    vplSolver solver;
    vplPlanes source, radiosity;
    vplPlanes shot, unshot, gain; // shooting: their sum is the radiosity
    float* area;                  // shooting
    int next;                     // shooting: the side that shoots next; -1: none
    double change, largest;       // of the last sweep: of radiosities, W/m^2
    bool finite;                  // all radiosities are
} vplSolve;

// What shooting needs before its first sweep.
void vplSolve_BeginShooting(vplSolve* solve);

void vplSolve_Sweep(vplSolve* solve);

#endif
