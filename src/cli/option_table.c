// SPDX-License-Identifier: MIT
// One table describes every option: how it is read, its range, its help and the commands that take it.
#include "cli/option.h"

#include <string.h>

enum {
    RENDER = 1,
    LIGHTS = 2,
    COMPARE = 4,
    INFO = 8,
    BENCH = 16,
    TRADEOFF = 32,
    BAKE = 64,
    SCENE = RENDER | LIGHTS | INFO | TRADEOFF,
    RADIOSITY = RENDER | INFO | TRADEOFF | BAKE
};

#define AT(field) offsetof(Arguments, field)

const Option OPTIONS[] = {
    {"-o", "FILE", RENDER, readText, AT(output), 0, 0, NULL,
     "picture to write: .png, .hdr, .pfm or, where built in, .exr (required)"},
    {"-o", "FILE", BAKE, readText, AT(output), 0, 0, NULL, "mesh to write: .ply (required)"},
    {"-o", "DIR", TRADEOFF, readText, AT(output), 0, 0, NULL,
     "folder for report.html, tradeoff.svg, tradeoff.csv and the reference, made if missing (required)"},
    {"--reference", "FILES", TRADEOFF, readText, AT(reference), 0, 0, NULL,
     "the true picture, linear and of the same size, or two independent ones: A,B; default: path traced"},
    {"--reference-spp", "N", TRADEOFF, readInt, AT(referenceSpp), 2, VPL_MAX_SAMPLES, NULL,
     "paths per pixel of the reference; default: as many as a third of the time allows"},
    {"--seeds", "K", TRADEOFF, readInt, AT(seeds), 1, 64, NULL, "seeds per setting; default 3"},
    {"--time", "S", TRADEOFF, readDouble, AT(seconds), 0, 1e9, NULL,
     "seconds of measuring, the cheapest settings first; default 300"},
    {"--sweeps", "LIST", TRADEOFF, readText, AT(sweeps), 0, 0, NULL,
     "only these sweeps, as in frontier,sampler; default: all"},
    {"--size", "WxH", RENDER | INFO | BENCH | TRADEOFF, readSize, 0, 0, 0, NULL,
     "pixels; default 1280x720, for tradeoff 320x180"},
    {"--antialias", "N", RENDER | INFO | TRADEOFF, readInt, AT(render.antialias), 1, 4096, NULL,
     "samples per pixel of rasterizing methods; default 1"},
    {"--frames", "A:B", RENDER, readFrames, 0, 0, 0, NULL,
     "frames A to B of the scene's paths, one picture each: out.png becomes out-0000.png and so on"},
    {"--camera", "I", RENDER | TRADEOFF | BAKE, readInt, AT(render.camera), 0, 1e9, NULL,
     "index of the scene's camera; default 0"},
    {"--method", "M", SCENE & ~TRADEOFF, readChoice, AT(render.method), 0, 0,
     "instant-radiosity|direct|path|keller|ssvp|radiosity",
     "instant-radiosity (default), direct: the scene's own lights only, path: the path-traced reference, "
     "keller: Instant Radiosity as published, ssvp: screen-space virtual point light propagation, or "
     "radiosity: patches and form factors"},
    {"--lighting", "L", SCENE, readChoice, AT(render.lighting), 0, 0, "physical|documented",
     "physical (default) or documented: the formulas as printed"},
    {"--particles", "N", SCENE, readInt, AT(render.particles.count), 0, VPL_MAX_LIGHTS, NULL,
     "particles shot from the light; default 10"},
    {"--reflectivity", "R", SCENE, readReflectivity, 0, 0, 1, NULL,
     "share of particles that go on at each step, [0, 1), or auto: the scene's mean; default 0.5"},
    {"--sampler", "S", SCENE, readChoice, AT(render.sampler), 0, 0, "auto|random|halton|hammersley",
     "auto (default): halton for keller and for --placement view, else random; or random, halton or "
     "hammersley"},
    {"--placement", "P", SCENE, readChoice, AT(render.placement), 0, 0, "particles|rsm|view",
     "where virtual lights go: particles (default): where they land; rsm: first hits are texels of "
     "reflective "
     "shadow maps; view: particles, of which those are kept that light what the camera sees"},
    {"--rsm-size", "N", SCENE, readInt, AT(render.rsmSize), 0, VPL_MAX_SHADOW_MAP, NULL,
     "texels along a side of a reflective shadow map; default 0: 256 for --placement rsm, 1024 for --method "
     "ssvp"},
    {"--clusters", "C", SCENE, readInt, AT(render.clusters), 1, VPL_MAX_LIGHTS, NULL,
     "clusters of first-bounce lights, each with a paraboloid map; ssvp; default 8"},
    {"--first-bounce", "N", SCENE, readInt, AT(render.firstBounce), 0, VPL_MAX_LIGHTS, NULL,
     "lights of the first bounce, samples of the reflective shadow map; ssvp; default 256"},
    {"--oversampling", "F", SCENE, readInt, AT(render.oversampling), 1, 1024, NULL,
     "where light of the first bounce leaves the scene, up to F times as many samples are taken, and about "
     "--first-bounce are kept: those whose light stays; ssvp; default 16; 1: as in the document"},
    {"--second-bounce", "N", SCENE, readInt, AT(render.secondBounce), 0, VPL_MAX_LIGHTS, NULL,
     "lights of the second bounce, samples of all paraboloid maps; ssvp; default 256"},
    {"--paraboloid", "N", SCENE, readInt, AT(render.paraboloidSize), 1, VPL_MAX_SHADOW_MAP, NULL,
     "texels along the side of a paraboloid map; ssvp; default 128"},
    {"--hemispheres", "H", SCENE, readInt, AT(render.hemispheres), 1, 2, NULL,
     "that a cluster sees: 1 (default): its lights do not shine behind the plane through it; 2: they do, in "
     "more than "
     "twice the time; ssvp"},
    {"--w1", "W", SCENE, readDouble, AT(render.w1), 0, 1e15, NULL,
     "weight of the distance between a light and a cluster, 1/metres; ssvp; default 0.6"},
    {"--w2", "W", SCENE, readDouble, AT(render.w2), 0, 1e15, NULL,
     "weight of the angle between their normals; ssvp; default 0.4"},
    {"--cluster-metric", "M", SCENE, readChoice, AT(render.clusterMetric), 0, 0,
     "one-minus|printed|one-minus-clamped|angle",
     "term of the normals n, m: one-minus (default): 1 - n.m; printed: max(n.m, 0), as in the document; "
     "one-minus-clamped: 1 - max(n.m, 0); angle: between them, radians; ssvp"},
    {"--cluster-place", "P", SCENE, readChoice, AT(render.clusterPlace), 0, 0, "member|mean",
     "where a cluster looks from: member (default): its light nearest to the mean; mean: maybe in mid-air; "
     "ssvp"},
    {"--second-weight", "W", SCENE, readChoice, AT(render.secondWeight), 0, 0, "cosine|printed",
     "cosine (default): second-bounce lights carry what a diffuse cluster sends to them; printed: all the "
     "same; ssvp"},
    {"--patch-size", "T", RADIOSITY, readFloat, AT(render.patchSize), 0, 1e15, NULL,
     "metres: triangles are bisected while an edge is longer; radiosity; default 0: see --patches"},
    {"--patches", "N", RADIOSITY, readInt, AT(render.radiosity.patches), 1, VPL_MAX_PATCHES, NULL,
     "about so many patches, where --patch-size is 0; radiosity; default 2000"},
    {"--subdivisions", "K", RADIOSITY, readInt, AT(render.subdivisions), 0, VPL_MAX_PATCH_ROUNDS, NULL,
     "rounds of bisection, at most; radiosity; default 40"},
    {"--patch-placement", "P", RADIOSITY, readChoice, AT(render.patchPlacement), 0, 0, "uniform|adaptive",
     "uniform (default): patches of one size, or adaptive: small ones where light changes much; radiosity"},
    {"--form-factors", "F", RADIOSITY, readChoice, AT(render.formFactors), 0, 0, "monte-carlo|incentre",
     "monte-carlo (default): several pairs of points per pair of patches, exact integrals for near ones, or "
     "incentre: one pair, as in the document; radiosity"},
    {"--form-samples", "N", RADIOSITY, readInt, AT(render.formSamples), 1, 1024, NULL,
     "pairs of points per pair of patches; radiosity; default 4"},
    {"--row-sums", "R", RADIOSITY, readChoice, AT(render.rowSums), 0, 0, "usual|keep|clamp|normalise",
     "form factors of a patch that sum to more than 1: keep, clamp to 1, or normalise all to 1; usual "
     "(default): clamp for monte-carlo, keep for incentre; radiosity"},
    {"--hierarchy", "H", RADIOSITY, readChoice, AT(render.hierarchy), 0, 0, "auto|off|on",
     "off: form factors of all pairs; on: links between groups of patches; auto (default): by their number; "
     "radiosity"},
    {"--link-error", "E", RADIOSITY, readDouble, AT(render.linkError), 1e-6, 1, NULL,
     "error of one link as a share of what its receiver gets; radiosity; default 0.002"},
    {"--patch-light", "N", RADIOSITY, readInt, AT(render.patchLightSamples), 0, VPL_PATCH_CELLS, NULL,
     "points of a patch at which lights' light is found; default 0: 16, of --form-factors incentre 1, its "
     "centre; radiosity"},
    {"--solver", "S", RADIOSITY, readChoice, AT(render.solver), 0, 0, "gauss-seidel|jacobi|shooting",
     "gauss-seidel (default), jacobi: a bounce per sweep, or shooting: the brightest first; radiosity"},
    {"--iterations", "I", RADIOSITY, readInt, AT(render.iterations), 0, VPL_MAX_SWEEPS, NULL,
     "sweeps of the solver, at most, with --frames per frame; radiosity; default 100"},
    {"--residual", "E", RADIOSITY, readDouble, AT(render.residual), 0, 1, NULL,
     "ends when a sweep changes no radiosity by more than this share of the largest; radiosity; default "
     "0.0001"},
    {"--interpolation", "I", RENDER | INFO | TRADEOFF, readChoice, AT(render.interpolation), 0, 0,
     "gouraud|none", "light over a patch: gouraud (default): linear between its corners, or none; radiosity"},
    {"--vertex-weight", "W", RADIOSITY, readChoice, AT(render.vertexWeight), 0, 0, "angle|area|equal",
     "of patches that meet at a corner: angle (default), area or, as in the document, equal; radiosity"},
    {"--sharpen", "N", RADIOSITY, readInt, AT(render.sharpen), 0, 64, NULL,
     "rounds in which corners are moved until patches show their light again, which means at corners smooth "
     "out; "
     "radiosity; default 4; 0: as in the document"},
    {"--coherence", "C", RENDER, readChoice, AT(render.coherence), 0, 0, "off|on",
     "on (default): frames of a sequence keep sample patterns, clusters and radiosities of the frame before; "
     "off: "
     "new ones; ssvp and radiosity"},
    {"--bounce", "B", SCENE, readChoice, AT(render.bounce), 0, 0, "auto|reflect|diffuse",
     "auto (default): reflect for documented lighting, diffuse for physical"},
    {"--seed", "S", SCENE | BAKE, readSeed, 0, 0, 0, NULL, "of all random numbers; default 0"},
    {"--pipeline", "P", RENDER | INFO | TRADEOFF, readChoice, AT(render.accumulation), 0, 0,
     "multipass|batched|deferred|interleaved|lightcuts|usual",
     "how virtual lights are added: usual (default): interleaved for ssvp, else deferred; multipass, batched "
     "or "
     "deferred, the same bits; interleaved: "
     "each "
     "pixel meets every K^2-th light, and neighbours share; or lightcuts: clusters of lights, within an "
     "error"},
    {"--batch", "M", RENDER | INFO | TRADEOFF, readInt, AT(render.batch), 1, VPL_MAX_LIGHTS, NULL,
     "virtual lights per pass of --pipeline batched; default 64"},
    {"--interleave", "K", RENDER | INFO | TRADEOFF, readInt, AT(render.interleave), 1, VPL_MAX_INTERLEAVE,
     NULL, "side of the square of pixels that share the lights of --pipeline interleaved; default 4"},
    {"--cut-error", "E", RENDER | INFO | TRADEOFF, readFloat, AT(render.cutError), 1e-6, 1, NULL,
     "error of --pipeline lightcuts as a share of the pixel's light: clusters err by an eighth of it at "
     "most; "
     "default 0.02"},
    {"--min-distance", "D", RENDER | TRADEOFF, readFloatOrAuto, AT(render.minDistance), 0, 1e15, NULL,
     "metres: cos cos / d^2 is bounded as cos cos / max(d^2, D^2); 0: unbounded; default auto"},
    {"--light-shadows", "V", RENDER | INFO | TRADEOFF, readChoice, AT(render.lightShadows), 0, 0,
     "usual|none|map|ray|auto|cluster",
     "none, map or ray: whether, and how, virtual lights cast shadows; auto: map or ray, whichever is "
     "cheaper; "
     "usual (default): none for instant-radiosity, auto for keller, and for ssvp by their clusters' "
     "paraboloid maps"},
    {"--compensation", "C", RENDER | INFO | TRADEOFF, readChoice, AT(render.compensation), 0, 0,
     "usual|none|rays",
     "what becomes of the light that --min-distance takes away: none: lost; rays: short rays find it; usual "
     "(default): rays for keller with shadows, else none"},
    {"--light-map", "N", RENDER | INFO | TRADEOFF, readInt, AT(render.lightMapSize), 1, VPL_MAX_SHADOW_MAP,
     NULL, "texels along the side of each virtual light's map, for --light-shadows map; default 256"},
    {"--lamp-lights", "N", RENDER | INFO | TRADEOFF, readInt, AT(render.areaLightSamples), 1, VPL_MAX_LIGHTS, NULL,
     "lights that stand for area emitters in direct light, with shadow rays; default 64"},
    {"--particle-geometry", "G", SCENE, readChoice, AT(render.particleGeometry), 0, 0, "exact|obb",
     "exact (default), or obb: particles stop at an object's oriented bounding box"},
    {"--spp", "N", RENDER | INFO, readInt, AT(render.samplesPerPixel), 1, VPL_MAX_SAMPLES, NULL,
     "paths per pixel of --method path; default 64"},
    {"--pixel", "P", RENDER, readChoice, AT(render.pixel), 0, 0, "area|centre",
     "area (default): --method path averages over each pixel; centre: looks at its centre, as other methods"},
    {"--max-bounces", "N", SCENE, readInt, AT(render.maxBounces), -1, VPL_MAX_BOUNCES, NULL,
     "diffuse reflections before the eye's last, of --method path and (up to 2) of ssvp; -1 (default): as "
     "many as it "
     "takes"},
    {"--passes", "N", RENDER, readInt, AT(render.passes), 0, VPL_MAX_PASSES, NULL,
     "pictures of --particles each, whose mean is the picture; default 1, or as many as --budget and "
     "--max-error "
     "ask for"},
    {"--budget", "MS", RENDER, readDouble, AT(render.budgetMs), 0, 1e12, NULL,
     "milliseconds: more passes, as long as they fit"},
    {"--max-error", "E", RENDER, readDouble, AT(render.maxError), 0, 1e9, NULL,
     "more passes, until the estimated rmse is at most E times the picture's mean"},
    {"--shadow-map", "N", RENDER | INFO | TRADEOFF, readInt, AT(render.shadowMapSize), 1, VPL_MAX_SHADOW_MAP,
     NULL, "texels along a face of the cube shadow map; default 1024"},
    {"--bias", "B", RENDER | TRADEOFF, readBias, 0, 0, 1e15, NULL,
     "static bias in metres, auto (default) or exact: what a plane needs at its angle"},
    {"--bias-slope", "B", RENDER | TRADEOFF, readBiasSlope, 0, 0, 1e15, NULL,
     "largest dynamic bias in metres"},
    {"--pcf", "S", RENDER | TRADEOFF, readInt, AT(render.shadow.pcfSamples), 1, VPL_MAX_PCF_SAMPLES, NULL,
     "shadow map samples per pixel; 1 gives hard shadows; default 16"},
    {"--pcf-offset", "O", RENDER | TRADEOFF, readFloatOrAuto, AT(render.shadow.pcfOffset), 0, 1e15, NULL,
     "radius of the disc of samples in metres, or auto (default)"},
    {"--show", "WHAT", RENDER, readShow, 0, 0, 0,
     "picture|depth|normals|shadow-map|shadow-factor|direct|indirect|light:K|overlay|bounce:K|rsm|rsm-"
     "samples|"
     "clusters|paraboloid:C|second-bounce|gather|denoised|patches|patch-radiosity|form-factor-sums|residual",
     "picture (default), depth, normals, shadow-map, shadow-factor, direct, indirect, light:K (K as in vpl "
     "lights), overlay, bounce:K (--method path: light after K reflections, 0 is direct); of ssvp: rsm, "
     "rsm-samples, "
     "clusters, paraboloid:C (cluster C's map), second-bounce, gather, denoised; of radiosity: patches, "
     "patch-radiosity, form-factor-sums, residual"},
    {"--exposure", "EV", RENDER | TRADEOFF | BAKE, readFloat, AT(write.exposure), -64, 64, NULL,
     "stops, PNG and the colours of PLY only: pixels times 2^EV; default 0"},
    {"--tonemap", "T", RENDER, readTonemap, AT(write.tonemap), 0, 0, "none|reinhard",
     "none or reinhard, PNG only; default: reinhard for ssvp, else none"},
    {"--stats", "FILE", RENDER | BAKE, readText, AT(stats), 0, 0, NULL, "write statistics as JSON"},
    {"--heatmap", "FILE", COMPARE, readText, AT(heatmap), 0, 0, NULL, "write a picture of the differences"},
    {"--heatmap-of", "WHAT", COMPARE, readChoice, AT(heat.of), 0, 0, "difference|relative|ssim|flip",
     "difference (default), relative, ssim (1 - SSIM) or flip (in magma colours)"},
    {"--heat-scale", "X", COMPARE, readFloat, AT(heat.scale), 0, 1e30, NULL,
     "value at the bright end; default: the largest, and 1 for ssim and flip"},
    {"--ppd", "P", COMPARE, readDouble, AT(heat.ppd), VPL_MIN_PPD, VPL_MAX_PPD, NULL,
     "pixels per degree of vision, for FLIP; default 67.02: 3840 pixels on 0.7 m seen from 0.7 m"},
    {"--region", "X,Y,W,H", COMPARE, readRegion, 0, 0, 0, NULL,
     "compare this rectangle only, as if it were cut out of both pictures"},
    {"--regions", "CxR", COMPARE, readGrid, 0, 0, 0, NULL,
     "also print means, ratio and rmse of each of C times R blocks"},
    {"--json", NULL, COMPARE | BENCH | INFO, readFlag, AT(json), 0, 0, NULL, "print JSON"},
    {"--runs", "N", BENCH, readInt, AT(runs), 1, 1000, NULL,
     "runs of which the median is printed, three at least of stages that take seconds; default 5"},
    {"--stage", "WORD", BENCH, readText, AT(stage), 0, 0, NULL,
     "only the stages (with --scaling: the series) whose name contains this, slow ones too"},
    {"--all", NULL, BENCH, readFlag, AT(all), 0, 0, NULL, "slow stages, too"},
    {"--scaling", NULL, BENCH, readFlag, AT(scaling), 0, 0, NULL,
     "instead: time against lights, pixels, triangles, threads and shadow map size, with fitted exponents"},
    {"--threads", "T", RENDER | BAKE | LIGHTS | BENCH | COMPARE | TRADEOFF, readThreads, 0, 0, 0, NULL,
     "worker threads, 0 (default, tradeoff: 1): one per processor; bench takes several: 1,2"},
    {"--isa", "I", RENDER | BAKE | LIGHTS | BENCH | TRADEOFF, readChoice, AT(context.isa), 0, 0,
     "auto|scalar|sse2|avx2|avx512", "auto (default), scalar, sse2, avx2, avx512: the same bits"},
    {"--quiet", NULL, ~0, readFlag, AT(quiet), 0, 0, NULL, "no progress bar, no warnings"},
    {"-v", NULL, ~0, readFlag, AT(verbose), 0, 0, NULL, "say more"},
    {"--help", NULL, ~0, readFlag, AT(help), 0, 0, NULL, "print this"},
};

const int OPTION_COUNT = sizeof OPTIONS / sizeof *OPTIONS;

int commandBit(const char* command)
{
    static const char* const names[] = {"render", "lights", "compare", "info", "bench", "tradeoff", "bake"};
    for (int i = 0; i < 7; i++) {
        if (strcmp(names[i], command) == 0) {
            return 1 << i;
        }
    }
    return 0;
}
