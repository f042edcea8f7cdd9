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

// Pixels along a window, and the weight of pixel i.
static inline int tapsOf(int side)
{
    return 2 * side - 1;
}

static inline float weightOf(int side, int i)
{
    return (float)(i < side ? i + 1 : 2 * side - 1 - i);
}

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
            for (int i = 0; i < VPL_LANES + tapsOf(side) - 1; i++) {
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
    for (int i = 0; i < 3 * part->rows * VPL_GATHER_RUNS; i++) {
        const int row = i / VPL_GATHER_RUNS % part->rows, x = i % VPL_GATHER_RUNS * VPL_LANES;
        const float* from = room->indirect[i / VPL_GATHER_RUNS / part->rows][row] + x;
        float sum[VPL_LANES] = {0};
        for (int k = 0; k < tapsOf(side); k++) {
            const float weight = weightOf(side, k);
            for (int l = 0; l < VPL_LANES; l++) {
                sum[l] += weight * from[k + l];
            }
        }
        memcpy(room->rowSums[i / VPL_GATHER_RUNS / part->rows][row] + x, sum, sizeof sum);
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
    const float inverse = 1 / (float)(side * side * side * side);
    for (int c = 0; c < 3; c++) {
        float sum[VPL_LANES] = {0};
        for (int i = 0; i < tapsOf(side); i++) {
            const float weight = weightOf(side, i);
            const float* from = room->rowSums[c][row + i] + x;
            for (int l = 0; l < VPL_LANES; l++) {
                sum[l] += weight * from[l];
            }
        }
        for (int l = 0; l < VPL_LANES; l++) {
            mean[c][l] = sum[l] * inverse;
        }
    }
}

// How far the pixels of a row of windows are from the plane of the triangle at (row0, x0): 0 on that triangle itself,
// infinity where another surface faces elsewhere or nothing is.
static void measureRow(const vplGatherRoom* room, int row0, int x0, int row, int x, int count,
                       float apart[VPL_GATHER_COLUMNS])
{
    const int32_t own = room->triangle[row0][x0];
    const float ox = room->normal[0][row0][x0], oy = room->normal[1][row0][x0],
                oz = room->normal[2][row0][x0];
    const float offset = room->offset[row0][x0];
    const int32_t* triangle = room->triangle[row] + x;
    const float *nx = room->normal[0][row] + x, *ny = room->normal[1][row] + x,
                *nz = room->normal[2][row] + x;
    const float *px = room->position[0][row] + x, *py = room->position[1][row] + x,
                *pz = room->position[2][row] + x;
    for (int i = 0; i < count; i++) {
        const float cosine = ox * nx[i] + oy * ny[i] + oz * nz[i];
        const float above = fabsf(ox * px[i] + oy * py[i] + oz * pz[i] - offset);
        const float other = cosine >= MIN_NORMALS ? above : INFINITY; // normals of nothing are 0
        apart[i] = triangle[i] == own ? 0 : other;
    }
}

// Sums a row of all windows.
static void sumRow(const vplGatherRoom* room, int side, int row, int x, const float apart[VPL_GATHER_COLUMNS],
                   const float slack[VPL_LANES], float count[VPL_LANES], float sum[3][VPL_LANES])
{
    float n[VPL_LANES] = {0}, red[VPL_LANES] = {0}, green[VPL_LANES] = {0}, blue[VPL_LANES] = {0};
    for (int i = 0; i < tapsOf(side); i++) {
        const float weight = weightOf(side, i);
        const float *r = room->indirect[0][row] + x + i, *g = room->indirect[1][row] + x + i,
                    *b = room->indirect[2][row] + x + i;
        for (int l = 0; l < VPL_LANES; l++) {
            const float taken = apart[i + l] <= slack[l] ? weight : 0;
            n[l] += taken;
            red[l] += taken * r[l];
            green[l] += taken * g[l];
            blue[l] += taken * b[l];
        }
    }
    memcpy(count, n, sizeof n);
    memcpy(sum[0], red, sizeof red);
    memcpy(sum[1], green, sizeof green);
    memcpy(sum[2], blue, sizeof blue);
}

// The same where the row shows the triangle of all their middles.
static void takeRow(const vplGatherRoom* room, int side, int row, int x, float count[VPL_LANES],
                    float sum[3][VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        count[l] = (float)(side * side);
        sum[0][l] = room->rowSums[0][row][x + l];
        sum[1][l] = room->rowSums[1][row][x + l];
        sum[2][l] = room->rowSums[2][row][x + l];
    }
}

// Adds the windows of those pixels that show the triangle of pixel `lane`.
static void addWindows(const vplGatherRoom* room, int side, int row, int x, int lane, float count[VPL_LANES],
                       float total[3][VPL_LANES])
{
    const int row0 = row + side - 1, x0 = x + side - 1;
    const int32_t own = room->triangle[row0][x0 + lane];
    float slack[VPL_LANES], apart[VPL_GATHER_COLUMNS];
    int32_t others = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t triangle = room->triangle[row0][x0 + l];
        const float most = MAX_DISTANCE * room->distance[row0][x0 + l];
        const float atLeast0 = most > 0 ? most : 0; // NaN: seen from within its plane
        slack[l] = triangle == own ? atLeast0 : -1;
        others |= triangle ^ own;
    }
    for (int i = 0; i < tapsOf(side); i++) {
        const float weight = weightOf(side, i);
        float sum[3][VPL_LANES], rowCount[VPL_LANES];
        if (others == 0 && room->uniform[row + i][x / VPL_LANES] == own) {
            takeRow(room, side, row + i, x, rowCount, sum);
        } else {
            measureRow(room, row0, x0 + lane, row + i, x, VPL_LANES + tapsOf(side) - 1, apart);
            sumRow(room, side, row + i, x, apart, slack, rowCount, sum);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            count[l] += weight * rowCount[l];
            total[0][l] += weight * sum[0][l];
            total[1][l] += weight * sum[1][l];
            total[2][l] += weight * sum[2][l];
        }
    }
}

// Mean over those pixels of each window that lie on the surface of its middle, for each triangle among these.
static void meanOfMixed(const vplGatherRoom* room, int side, int row, int x, float mean[3][VPL_LANES])
{
    const int32_t* own = room->triangle[row + side - 1] + x + side - 1;
    float count[VPL_LANES] = {0}, total[3][VPL_LANES] = {{0}};
    for (int l = 0; l < VPL_LANES; l++) {
        bool seen = own[l] == 0;
        for (int k = 0; k < l; k++) {
            seen |= own[k] == own[l];
        }
        if (!seen) {
            addWindows(room, side, row, x, l, count, total);
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        const float inverse = count[l] > 0 ? 1 / count[l] : 0; // nothing is in the middle
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
    const int32_t* triangles = room->triangle[row + side - 1] + x + side - 1;
    bool uniform = room->uniform[row][x / VPL_LANES] != 0;
    for (int i = 1; i < tapsOf(side); i++) {
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
    if (!s->irradiance) {
        reflect(s, triangles, uniform, seen, mean);
    }
    addToPixels(mean, pixels, part->width - x);
}

void VPL_KERNEL(vplGatherTile)(void* data, int task, int worker)
{
    const vplShading* s = data;
    const vplInterleave* w = s->interleave;
    const vplImage* image = s->image;
    vplGatherRoom* room = &w->rooms[worker];
    const int side = w->side, reach = side - 1;
    Part part = {.x = task % w->tilesX * VPL_GATHER_WIDTH, .y = task / w->tilesX * VPL_GATHER_HEIGHT};
    part.width = image->width - part.x < VPL_GATHER_WIDTH ? image->width - part.x : VPL_GATHER_WIDTH;
    part.height = image->height - part.y < VPL_GATHER_HEIGHT ? image->height - part.y : VPL_GATHER_HEIGHT;
    part.columns = VPL_GATHER_WIDTH + tapsOf(side) - 1;
    part.rows = part.height + tapsOf(side) - 1;
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
