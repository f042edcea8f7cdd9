// SPDX-License-Identifier: MIT
#include "path_scenes.h"

vplScene* newScene(vplContext* context)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    return scene;
}

int addGrey(vplScene* scene, float rho, float emission)
{
    int index;
    vplMaterialDef def = vplDefaultMaterialDef();
    def.diffuse = (vplRgb){rho, rho, rho};
    def.emission = (vplRgb){emission, emission, emission};
    assert_int_equal(vplScene_AddMaterial(scene, &def, &index), VPL_SUCCESS);
    return index;
}

void addQuad(vplScene* scene, int material, vplVec3 place, int quarters, float size)
{
    vplObjectDef def = vplDefaultObjectDef();
    def.material = material;
    def.transform =
        vplMat4_FromParts(place, (double[3]){quarters * VPL_PI / 2, 0, 0}, (vplVec3){size, size, 1});
    assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
}

void addRoom(vplScene* scene, int material)
{
    for (int face = 0; face < 6; face++) {
        static const vplVec3 places[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                          {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
        static const double turns[6][2] = {{0, -1}, {0, 1}, {1, 0}, {-1, 0}, {0, 2}, {0, 0}}; // about x, y
        vplObjectDef def = vplDefaultObjectDef();
        def.material = material;
        const double rotate[3] = {turns[face][0] * VPL_PI / 2, turns[face][1] * VPL_PI / 2, 0};
        def.transform = vplMat4_FromParts(places[face], rotate, (vplVec3){2, 2, 1});
        assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    }
}

void addSphere(vplScene* scene, int material, vplVec3 centre, float radius, int n, bool smooth)
{
    const int perFace = (n + 1) * (n + 2) / 2;
    vplVec3* positions = malloc((size_t)(8 * perFace) * sizeof *positions);
    uint32_t* indices = malloc((size_t)(8 * n * n * 3) * sizeof *indices);
    int vertices = 0, count = 0;
    for (int face = 0; face < 8; face++) {
        const float sx = face & 1 ? -1 : 1, sy = face & 2 ? -1 : 1, sz = face & 4 ? -1 : 1;
        const bool turned = sx * sy * sz < 0;
        for (int i = 0; i <= n; i++) {
            for (int j = 0; j <= n - i; j++) {
                float x = sx * (float)i, y = sy * (float)j, z = sz * (float)(n - i - j);
                float length = sqrtf(x * x + y * y + z * z);
                const int at = vertices + i * (n + 1) - i * (i - 1) / 2 + j;
                positions[at] = (vplVec3){x / length, y / length, z / length};
                const uint32_t a = (uint32_t)at, right = a + 1, below = (uint32_t)(at + n + 1 - i);
                if (i + j < n) {
                    const uint32_t up[3] = {a, turned ? right : below, turned ? below : right};
                    memcpy(indices + 3 * count++, up, sizeof up);
                }
                if (i + j < n - 1) {
                    const uint32_t down[3] = {right, turned ? below + 1 : below, turned ? below : below + 1};
                    memcpy(indices + 3 * count++, down, sizeof down);
                }
            }
        }
        vertices += perFace;
    }
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = positions;
    mesh.normals = smooth ? positions : NULL;
    mesh.indices = indices;
    mesh.vertexCount = vertices;
    mesh.triangleCount = count;
    vplObjectDef def = vplDefaultObjectDef();
    def.type = VPL_OBJECT_MESH;
    def.material = material;
    def.transform = vplMat4_FromParts(centre, (double[3]){0, 0, 0}, (vplVec3){radius, radius, radius});
    assert_int_equal(vplScene_AddMesh(scene, &mesh, &def.mesh), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    free(positions);
    free(indices);
}

vplEmitterDef* addWhite(vplScene* scene, vplEmitterType type, vplVec3 position, float intensity)
{
    static vplEmitterDef def; // static, so that the caller can compare with it
    def = vplDefaultEmitterDef();
    def.type = type;
    def.position = position;
    def.intensity = (vplRgb){intensity, 2 * intensity, 0};
    assert_int_equal(vplScene_AddEmitter(scene, &def, NULL), VPL_SUCCESS);
    return &def;
}

void addCamera(vplScene* scene, vplVec3 eye, vplVec3 target, double fovY)
{
    vplCameraDef def = vplDefaultCameraDef();
    def.eye = eye;
    def.target = target;
    def.up = eye.x == target.x && eye.z == target.z ? (vplVec3){0, 0, -1} : (vplVec3){0, 1, 0};
    def.nearPlane = 1e-3;
    def.farPlane = 1e4;
    def.fovY = fovY;
    assert_int_equal(vplScene_AddCamera(scene, &def, NULL), VPL_SUCCESS);
}

vplRenderOptions pathOptions(int size, int samples)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_PATH;
    o.output.width = o.output.height = size;
    o.path.samples = samples;
    return o;
}

double meanOfImage(const vplImage* image, int channel)
{
    double sum = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        sum += (double)image->pixels[3 * i + channel];
    }
    return sum / image->width / image->height;
}

double radianceOf(const vplScene* scene, const vplRenderOptions* options, int channel)
{
    vplImage* image = renderScene(scene, options, NULL);
    double mean = meanOfImage(image, channel);
    vplImage_Destroy(image);
    return mean;
}

vplImage* renderShown(const vplScene* scene, vplShow show, int bounce)
{
    vplRenderOptions options = pathOptions(32, 5);
    options.maxBounces = 3;
    options.output.show = show;
    options.output.showIndex = bounce;
    return renderScene(scene, &options, NULL);
}

vplScene* addAllLights(vplScene* scene, int n)
{
    addRoom(scene, addGrey(scene, 0.6f, 0));
    addQuad(scene, addGrey(scene, 0.3f, 4), (vplVec3){0.3f, 0.6f, 0}, 1, 0.5f);
    addSphere(scene, addGrey(scene, 0.8f, 0), (vplVec3){-0.4f, -0.5f, 0}, 0.4f, n, true);
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0.5f, -0.5f, 0.3f}, 0.4f);
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){-0.5f, 0.5f, -0.3f}, 0.2f);
    addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){-0.5f, 0.8f, 0.3f}, 2);
    addCamera(scene, (vplVec3){0, 0, 0.9f}, (vplVec3){0, -0.1f, -1}, 1.4);
    return scene;
}

double squaredDifference(const vplImage* a, const vplImage* b)
{
    double squares = 0;
    for (int i = 0; i < 3 * a->width * a->height; i++) {
        double apart = (double)a->pixels[i] - (double)b->pixels[i];
        squares += apart * apart;
    }
    return squares / (3.0 * a->width * a->height);
}

vplImage* traceWith(const vplScene* scene, const vplGeometry* geometry, const vplPathDef* def, int samples,
                    vplPathStats* stats)
{
    vplPathTracer* tracer;
    vplImage* image;
    vplPathDef d = *def;
    d.camera = vplScene_GetCamera(scene, 0);
    d.emitterCount = vplScene_GetEmitterCount(scene);
    d.emitters = d.emitterCount ? vplScene_GetEmitter(scene, 0) : NULL;
    d.width = d.height = 24;
    assert_int_equal(vplPathTracer_Create(geometry, &d, &tracer), VPL_SUCCESS);
    assert_int_equal(vplPathTracer_Pass(tracer, samples, NULL, NULL, 0, 1), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(geometry->context, 24, 24, &image), VPL_SUCCESS);
    vplPathTracer_Resolve(tracer, image, stats);
    vplPathTracer_Destroy(tracer);
    return image;
}
