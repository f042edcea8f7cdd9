// SPDX-License-Identifier: MIT
// The second step of interleaved shading: every pixel takes the mean indirect irradiance of the K x K pixels around
// it that lie on about the same surface, and reflects it. Sums go along the rows first, then over the rows:
// where a run of 16 pixels and all their windows show one triangle, the sums of rows are shared, and the bits are
// those of the windows summed one by one.
#include "base/isa.h"
#include "geometry/triangle.h"
#include "math/vec.h"
#include "shading/gather.h"
#include "shading/resolve.h"

vplTaskFcn VPL_KERNEL(vplGatherTile);

#define MIN_NORMALS  0.9f  // least product of two normals of one surface
#define MAX_DISTANCE 0.01f // from the tangent plane, as a share of the distance along the view axis

// The part of the picture that a task writes, and the rows and columns that its windows reach.
typedef struct Part {
    int x, y, width, height;
    int rows, columns;
    bool mixed; // some window shows several triangles, or a triangle and nothing
    bool any;
} Part;

// Copies a plane's rows, 0 outside the picture. `to` has VPL_GATHER_COLUMNS values per row.
static void loadPlane(const vplImage* image, const float* plane, const Part* part, int reach, float* to)
{
    int first = reach - part->x, end = image->width - part->x + reach; // columns of the picture
    first = first > 0 ? first : 0;
    end = end < part->columns ? end : part->columns;
    for (int row = 0; row < part->rows; row++, to += VPL_GATHER_COLUMNS) {
        const int y = part->y - reach + row;
        if (y < 0 || y >= image->height) {
            memset(to, 0, VPL_GATHER_COLUMNS * sizeof *to);
            continue;
        }
        const float* from = plane + (size_t)y * (size_t)image->width + (part->x - reach + first);
        memset(to, 0, (size_t)first * sizeof *to);
        memcpy(to + first, from, (size_t)(end - first) * sizeof *to);
        memset(to + end, 0, (size_t)(VPL_GATHER_COLUMNS - end) * sizeof *to);
    }
}

static void findUniform(int side, vplGatherRoom* room, Part* part)
{
    part->mixed = part->any = false;
    for (int row = 0; row < part->rows; row++) {
        for (int run = 0; run < VPL_GATHER_RUNS; run++) {
            const int32_t* at = room->triangle[row] + run * VPL_LANES;
            int32_t different = 0, any = 0;
            for (int i = 0; i < VPL_LANES + side - 1; i++) {
                different |= at[i] ^ at[0];
                any |= at[i];
            }
            room->uniform[row][run] = different ? 0 : at[0];
            part->mixed |= different != 0;
            part->any |= any != 0;
        }
    }
    for (int row = 1; row < part->rows; row++) {
        for (int run = 0; run < VPL_GATHER_RUNS; run++) {
            part->mixed |= room->uniform[row][run] != room->uniform[row - 1][run];
        }
    }
}

static void sumRows(int side, vplGatherRoom* room, const Part* part)
{
    for (int c = 0; c < 3; c++) {
        for (int row = 0; row < part->rows; row++) {
            const float* restrict from = room->indirect[c][row];
            float* restrict to = room->rowSums[c][row];
            for (int x = 0; x < VPL_GATHER_WIDTH; x++) {
                to[x] = from[x];
            }
            for (int i = 1; i < side; i++) {
                for (int x = 0; x < VPL_GATHER_WIDTH; x++) {
                    to[x] += from[x + i];
                }
            }
        }
    }
}

// The planes of the triangles in a row.
static void findPlanes(const vplShading* s, const int32_t* triangles, int row, int columns,
                       vplGatherRoom* room)
{
    vplVec3 n = {0, 0, 0};
    float offset = 0;
    for (int i = 0, last = 0; i < columns; i++) {
        if (triangles[i] != last) {
            last = triangles[i];
            n = last == 0 ? vplVec(0, 0, 0) : vplGetFacet(s, last - 1).normal;
            const vplVec3 eye = s->view->eye;
            offset =
                last == 0 ? 0 : vplDot(n, vplSub(vplGeometry_Corners(s->geometry, last - 1).corner[0], eye));
        }
        room->normal[0][row][i] = n.x;
        room->normal[1][row][i] = n.y;
        room->normal[2][row][i] = n.z;
        room->offset[row][i] = offset;
    }
}

// Where the lines of sight of a row meet these planes; NaN where nothing is.
static void findPositions(const vplView* view, const Part* part, int reach, int row, vplGatherRoom* room)
{
    const double y = 1 - (2 * (part->y - reach + row) + 1) / (double)view->height - view->offsetY;
    const double x = (2 * (part->x - reach) + 1) / (double)view->width - 1 - view->offsetX;
    const float up = (float)(y / view->scaleY), right0 = (float)(x / view->scaleX);
    const float step = (float)(2 / (double)view->width / view->scaleX);
    const vplVec3 r = view->right, f = vplAdd(view->forward, vplScale(up, view->up));
    const float *nx = room->normal[0][row], *ny = room->normal[1][row], *nz = room->normal[2][row];
    float *px = room->position[0][row], *py = room->position[1][row], *pz = room->position[2][row];
    for (int i = 0; i < part->columns; i++) {
        const float right = right0 + (float)i * step;
        const float x1 = f.x + right * r.x, y1 = f.y + right * r.y, z1 = f.z + right * r.z;
        const float w = room->offset[row][i] / (nx[i] * x1 + ny[i] * y1 + nz[i] * z1);
        room->distance[row][i] = w;
        px[i] = w * x1;
        py[i] = w * y1;
        pz[i] = w * z1;
    }
}

// Mean over the windows of 16 pixels of one triangle.
static void meanOfUniform(const vplGatherRoom* room, int side, int row, int x, float mean[3][VPL_LANES])
{
    const float inverse = 1 / (float)(side * side);
    for (int c = 0; c < 3; c++) {
        float sum[VPL_LANES] = {0};
        for (int i = 0; i < side; i++) {
            const float* from = room->rowSums[c][row + i] + x;
            for (int l = 0; l < VPL_LANES; l++) {
                sum[l] += from[l];
            }
        }
        for (int l = 0; l < VPL_LANES; l++) {
            mean[c][l] = sum[l] * inverse;
        }
    }
}

// One row of the windows of 16 pixels whose own place is `at`, (row, column).
typedef struct Centre {
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES];
    float offset[VPL_LANES], slack[VPL_LANES]; // of the tangent plane: |n.q - offset| <= slack
    int32_t triangle[VPL_LANES];
} Centre;

static void findCentre(const vplGatherRoom* room, int row, int column, Centre* c)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const int x = column + l;
        c->nx[l] = room->normal[0][row][x];
        c->ny[l] = room->normal[1][row][x];
        c->nz[l] = room->normal[2][row][x];
        c->offset[l] = room->offset[row][x];
        c->slack[l] = MAX_DISTANCE * room->distance[row][x];
        c->triangle[l] = room->triangle[row][x];
    }
}

// Adds the pixels at `x` of the window's row.
static inline void addTaps(const vplGatherRoom* room, const Centre* c, int row, int x, float count[VPL_LANES],
                           float sum[3][VPL_LANES])
{
    const int32_t* triangle = room->triangle[row] + x;
    const float *nx = room->normal[0][row] + x, *ny = room->normal[1][row] + x,
                *nz = room->normal[2][row] + x;
    const float *px = room->position[0][row] + x, *py = room->position[1][row] + x,
                *pz = room->position[2][row] + x;
    const float *r = room->indirect[0][row] + x, *g = room->indirect[1][row] + x,
                *b = room->indirect[2][row] + x;
    for (int l = 0; l < VPL_LANES; l++) {
        const float cosine = c->nx[l] * nx[l] + c->ny[l] * ny[l] + c->nz[l] * nz[l];
        const float above = c->nx[l] * px[l] + c->ny[l] * py[l] + c->nz[l] * pz[l] - c->offset[l];
        const float er = r[l], eg = g[l], eb = b[l];
        const int near = (cosine >= MIN_NORMALS) & (above <= c->slack[l]) & (-above <= c->slack[l]);
        const int same = (triangle[l] == c->triangle[l]) | (near & (triangle[l] != 0));
        count[l] += same ? 1.0f : 0.0f;
        sum[0][l] += same ? er : 0.0f;
        sum[1][l] += same ? eg : 0.0f;
        sum[2][l] += same ? eb : 0.0f;
    }
}

// Mean over those pixels of each window that lie on the surface of its middle.
static void meanOfMixed(const vplGatherRoom* room, int side, int row, int x, float mean[3][VPL_LANES])
{
    Centre centre;
    findCentre(room, row + side / 2, x + side / 2, &centre);
    float count[VPL_LANES] = {0}, total[3][VPL_LANES] = {{0}};
    for (int i = 0; i < side; i++) {
        float sum[3][VPL_LANES] = {{0}};
        for (int j = 0; j < side; j++) {
            addTaps(room, &centre, row + i, x + j, count, sum);
        }
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                total[c][l] += sum[c][l];
            }
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        const float inverse = 1 / count[l]; // at least 1: the pixel itself
        mean[0][l] = total[0][l] * inverse;
        mean[1][l] = total[1][l] * inverse;
        mean[2][l] = total[2][l] * inverse;
    }
}

// The triangle that was looked up last.
typedef struct Seen {
    int32_t triangle;
    vplReflector reflector;
} Seen;

static inline void see(const vplShading* s, int32_t triangle, Seen* seen)
{
    if (triangle != seen->triangle) {
        seen->triangle = triangle;
        seen->reflector = vplGetReflector(s, triangle - 1);
    }
}

// Turns irradiance into radiance.
static void reflect(const vplShading* s, const int32_t triangles[VPL_LANES], bool uniform, Seen* seen,
                    float mean[3][VPL_LANES])
{
    if (uniform) {
        see(s, triangles[0], seen);
        for (int c = 0; c < 3; c++) {
            const float factor = (float)seen->reflector.factor[c];
            for (int l = 0; l < VPL_LANES; l++) {
                mean[c][l] *= factor;
            }
        }
        return;
    }
    for (int l = 0; l < VPL_LANES; l++) {
        see(s, triangles[l], seen);
        for (int c = 0; c < 3; c++) {
            mean[c][l] *= (float)seen->reflector.factor[c];
        }
    }
}

static void addToPixels(float values[3][VPL_LANES], float* pixels, int count)
{
    _Alignas(64) float row[3 * VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        row[3 * l] = values[0][l];
        row[3 * l + 1] = values[1][l];
        row[3 * l + 2] = values[2][l];
    }
    if (count >= VPL_LANES) {
        for (int i = 0; i < 3 * VPL_LANES; i++) {
            pixels[i] += row[i];
        }
        return;
    }
    for (int i = 0; i < 3 * count; i++) {
        pixels[i] += row[i];
    }
}

// Pixels x .. x + 15 of one row of the part.
static void gatherRun(const vplShading* s, const vplGatherRoom* room, const Part* part, int row, int x,
                      Seen* seen)
{
    const int side = s->interleave->side;
    const int32_t* triangles = room->triangle[row + side / 2] + x + side / 2;
    bool uniform = room->uniform[row][x / VPL_LANES] != 0;
    for (int i = 1; i < side; i++) {
        uniform &= room->uniform[row + i][x / VPL_LANES] == room->uniform[row][x / VPL_LANES];
    }
    float mean[3][VPL_LANES];
    if (uniform) {
        meanOfUniform(room, side, row, x, mean);
    } else {
        int32_t any = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            any |= triangles[l];
        }
        if (any == 0) {
            return;
        }
        meanOfMixed(room, side, row, x, mean);
    }
    float* pixels =
        s->image->pixels + 3 * ((size_t)(part->y + row) * (size_t)s->image->width + (size_t)(part->x + x));
    reflect(s, triangles, uniform, seen, mean);
    addToPixels(mean, pixels, part->width - x);
}

void VPL_KERNEL(vplGatherTile)(void* data, int task, int worker)
{
    const vplShading* s = data;
    const vplInterleave* w = s->interleave;
    const vplImage* image = s->image;
    vplGatherRoom* room = &w->rooms[worker];
    const int side = w->side, reach = side / 2;
    Part part = {.x = task % w->tilesX * VPL_GATHER_WIDTH, .y = task / w->tilesX * VPL_GATHER_HEIGHT};
    part.width = image->width - part.x < VPL_GATHER_WIDTH ? image->width - part.x : VPL_GATHER_WIDTH;
    part.height = image->height - part.y < VPL_GATHER_HEIGHT ? image->height - part.y : VPL_GATHER_HEIGHT;
    part.columns = VPL_GATHER_WIDTH + side - 1;
    part.rows = part.height + side - 1;
    loadPlane(image, vplGatherPlane(w, VPL_GATHER_TRIANGLE), &part, reach, (float*)room->triangle[0]);
    findUniform(side, room, &part);
    if (!part.any) {
        return;
    }
    for (int c = 0; c < 3; c++) {
        loadPlane(image, vplGatherPlane(w, VPL_GATHER_INDIRECT + c), &part, reach, room->indirect[c][0]);
    }
    sumRows(side, room, &part);
    if (part.mixed) {
        for (int row = 0; row < part.rows; row++) {
            findPlanes(s, room->triangle[row], row, part.columns, room);
            findPositions(s->view, &part, reach, row, room);
        }
    }
    Seen seen = {0, {{0}, {0}}};
    for (int row = 0; row < part.height; row++) {
        for (int x = 0; x < part.width; x += VPL_LANES) {
            gatherRun(s, room, &part, row, x, &seen);
        }
    }
}
