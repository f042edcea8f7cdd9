// SPDX-License-Identifier: MIT
// The exchange of light, F times a vector, by rows of form factors or by links; and the sweeps of solvers.
#ifndef VPL_RADIOSITY_SOLVE_H
#define VPL_RADIOSITY_SOLVE_H

#include "radiosity/factors/shared_rows.h"
#include "radiosity/links/links.h"
#include "radiosity/sides/side.h"

// ---- the exchange (exchange.c)

typedef struct vplExchange {
    const vplTransport* transport;
    vplContext* context;
    const vplRadiosityKernels* kernels;
    int count;
    vplPlanes reflectance;
    double (*sums)[3];           // results of the last vplExchange_Gather
    vplLinkScratch nodes;        // for links
    const vplSharedRows* shared; // form factors of a team; NULL: of this process alone
    float* rooms;                // for its rows, one per worker
    vplTeamMail mail;
} vplExchange;

// VPL_INVALID_ARGUMENT unless the transport has either factors or links, for as many sides as it has, and the team that
// shares the factors is there.
vplResult vplTransport_Check(const vplTransport* transport);

// Allocates from `scratch`.
vplResult vplExchange_Open(vplArena* scratch, const vplTransport* transport, vplExchange* exchangeOut);

// sums = F x: for all sides or, with form factors, for the sides in [first, end).
vplResult vplExchange_Gather(vplExchange* exchange, const vplPlanes* x);
vplResult vplExchange_GatherRows(vplExchange* exchange, const vplPlanes* x, int first, int end);

// Fills the spectral radius and the sums of rows. Overwrites `x`.
vplResult vplFindSpectrum(vplExchange* exchange, vplPlanes* x, vplSolveStats* stats);

// ---- solvers (sweep.c)

// A solution in progress.
typedef struct vplSolve {
    vplExchange exchange;
    const vplSolveDef* def;
    vplSolveStats stats;
    bool hasSpectrum; // the stats have their spectral radius and sums of rows
    vplPlanes source, radiosity, scratch;
    vplPlanes shot, unshot, gain; // shooting: shot + unshot is the radiosity
    float* area;                  // shooting
    int next;                     // shooting: the side that shoots next; -1: none
    double change, largest;       // of the last sweep: the largest change and the largest radiosity, W/m^2
    double dark;                  // W/m^2: the least radiosity that a change is divided by
    // Sums over all sides and channels of the last sweep: relative change times area, and area. Their ratio is the mean relative change.
    double relative, weight;
    bool finite; // all radiosities are in the range of float
} vplSolve;

// Prepares the first sweep of shooting.
vplResult vplSolve_BeginShooting(vplSolve* solve);

vplResult vplSolve_Sweep(vplSolve* solve);

#endif
