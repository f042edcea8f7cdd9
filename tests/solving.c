// SPDX-License-Identifier: MIT
#include "solving.h"

const vplSolver SOLVERS[] = {VPL_SOLVER_GAUSS_SEIDEL, VPL_SOLVER_JACOBI, VPL_SOLVER_SHOOTING};

vplSolveDef sweeps(vplSolver solver, int iterations)
{
    vplSolveDef def = vplDefaultSolveDef();
    def.solver = solver;
    def.iterations = iterations;
    def.residual = 0;
    return def;
}

vplSolveStats solve(const Exchange* e, const vplSolveDef* def, const vplRgb* source, vplRgb* radiosity)
{
    vplSolveStats stats;
    memcpy(radiosity, source, (size_t)e->sides.count * sizeof *radiosity);
    if (vplSolveRadiosity(&e->transport, def, source, radiosity, &stats) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return stats;
}

vplRgb grey(double x)
{
    return (vplRgb){(float)x, (float)x, (float)x};
}

void assertRatio(double value, double wanted, double tolerance, const char* what, int row)
{
    assertNear(value, wanted, tolerance * fabs(wanted), what, row);
}

void fillSources(vplRgb* source, int count, uint64_t seed)
{
    for (int i = 0; i < count; i++) {
        const uint64_t at = 3 * (uint64_t)i;
        source[i] = (vplRgb){(float)uniformAt(seed, at), (float)uniformAt(seed, at + 1),
                             (float)uniformAt(seed, at + 2)};
    }
}

double sphereIrradiance(const Exchange* e, const vplRgb* source, int channel)
{
    double emitted = 0, kept = 0, area = 0;
    for (int i = 0; i < e->sides.count; i++) {
        const double a = (double)e->side[i].area;
        emitted += a * (double)(&source[i].r)[channel];
        kept += a * (double)(&e->side[i].reflectance.r)[channel];
        area += a;
    }
    return emitted / area / (1 - kept / area);
}

void openCube(Exchange* e, vplContext* context, float rho)
{
    const double opposite = 0.19982489569838745;
    openExchange(e, context, 6);
    setReflectance(e, rho);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            e->rows[6 * i + j] = (float)(i == j ? 0 : (i ^ 1) == j ? opposite : (1 - opposite) / 4);
        }
    }
}
