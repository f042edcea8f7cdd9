// SPDX-License-Identifier: MIT
// Tests of meshes in scenes: their materials, JSON scenes that name OBJ files, and OBJ files loaded as
// scenes.
#include "obj_support.h"

#include <stdlib.h>
#include <unistd.h>

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"

TEST_ALONE(MissingFilesAndMaterialsAreToldOnceAndGrey)
{
    Desk d;
    openDesk(&d);
    readText(&d, "mtllib none.mtl\nmtllib none.mtl\nmtllib . one.mtl\n" TRIANGLE
                 "usemtl white\nf 1 2 3\nusemtl black\nf 1 2 3\nusemtl white\nf 1 2 3\nusemtl idle\n");
    assert_int_equal(countOf(d.said, "a.obj:1:8: there is no file"), 1);
    assert_int_equal(countOf(d.said, "/none.mtl; its materials are grey"), 1);
    assert_int_equal(countOf(d.said, "a.obj:3:8: there is no file"), 1); // the path is a folder
    assert_int_equal(countOf(d.said, "a.obj:3:10: there is no file"), 1);
    assert_int_equal(countOf(d.said, "material \"white\" is not defined, taken as grey"), 1);
    assert_int_equal(countOf(d.said, "material \"black\" is not defined, taken as grey"), 1);
    assert_int_equal(countOf(d.said, "\n"), 5); // no message about the material that no face uses
    assert_int_equal(countOf(d.said, "warning: "), 5);
    assert_int_equal(vplScene_GetMaterialCount(d.scene), 3);
    assert_null(vplScene_GetMaterial(d.scene, 0)->name); // material of the face before the first usemtl
    for (int i = 0; i < 3; i++) {
        assertColour(vplScene_GetMaterial(d.scene, i)->diffuse, 0.5, 0.5, 0.5);
        assertColour(vplScene_GetMaterial(d.scene, i)->emission, 0, 0, 0);
    }
    closeDesk(&d);
}

TEST_ALONE(ManyMissingThingsAreNotAllTold)
{
    Desk d;
    openDesk(&d);
    char text[8000] = TRIANGLE;
    for (int i = 0; i < 40; i++) {
        snprintf(text + strlen(text), 200, "mtllib %d.mtl\nusemtl m%d\nf 1 2 3\nword%d 1\n", i, i, i);
    }
    readText(&d, text);
    assert_int_equal(countOf(d.said, "there is no file"), 8);
    assert_int_equal(countOf(d.said, "is not defined, taken as grey"), 8);
    assert_int_equal(countOf(d.said, "40 materials in all are not defined"), 1);
    assert_int_equal(countOf(d.said, "is not supported and has no effect"), 16);
    assert_int_equal(countOf(d.said, "further such statements are not reported"), 1);
    closeDesk(&d);
}

TEST_ALONE(WhatIsNotUnderstoodIsToldOnceEach)
{
    Desk d;
    openDesk(&d);
    writeText(d.mtl, "newmtl a\nKd 2 0.5 1.5\nmap_Kd a.png\nKa 1 1 1\nKs 1 1 1\nNs 1\nNi 1\nd 0.5\nTr 1\nTf "
                     "1 1 1\nillum 2\n"
                     "newmtl b\nKd 0.5 0.5 3\nmap_Kd b.png\nbump b.png\nKd spectral b.rfl\n"
                     "newmtl a\nKd 0 0 0\nKe 5\nnewmtl a\n");
    readText(&d, "mtllib a.mtl\nmtllib a.mtl\n" TRIANGLE "usemtl a\nf 1 2 3\nl 1 2\nl 2 3\np 1\nvp 0 0\n");
    static const char* const told[] = {
        "a.mtl:2:1: Kd above 1 is taken as 1 (2 such lines)",
        "a.png: there is no such file; it is taken as grey\n",
        "a.mtl:15:1: bump is not supported and has no effect\n",
        "a.mtl:16:4: spectral is not supported and has no effect\n",
        "a.mtl:17:8: this material has a definition already, which stays (2 such",
        "a.obj:9:1: l is not supported and has no effect\n",
        "a.obj:11:1: p is not supported and has no effect\n",
        "a.obj:12:1: vp is not supported and has no effect\n"};
    for (size_t i = 0; i < sizeof told / sizeof *told; i++) {
        if (countOf(d.said, told[i]) != 1) {
            fail_msg("%s %d times in:\n%s", told[i], countOf(d.said, told[i]), d.said);
        }
    }
    assert_int_equal(countOf(d.said, "warning: "), (int)(sizeof told / sizeof *told));
    assert_int_equal(countOf(d.said, "\n"), (int)(sizeof told / sizeof *told));
    assertColour(vplScene_GetMaterial(d.scene, 1)->diffuse, 1, 0.5, 1);
    assertColour(vplScene_GetMaterial(d.scene, 1)->emission, 0, 0, 0);
    closeDesk(&d);
}

TEST_ALONE(FacesThatCrossThemselvesAreToldOnce)
{
    Desk d;
    openDesk(&d);
    const vplMeshDef* mesh =
        readText(&d, "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 2 1 0\nv 9 9 1\n"
                     "f 1 2 3 4\nf 1 2 4 3\nf 1 2 3 4\nf 1 2 2 1\n"); // the last face has no area
    assert_int_equal(mesh->triangleCount, 6);
    assert_int_equal(countOf(d.said, "\n"), 2);
    assert_int_equal(countOf(d.said, "left out 2 triangles without area"), 1);
    assert_non_null(strstr(d.said, "a.obj:6:1: the outline of this face crosses itself"));
    assert_non_null(strstr(d.said, "(2 such faces)"));
    closeDesk(&d);
}

TEST_ALONE(FilesMayShareNamesOfMaterials)
{
    Desk d;
    openDesk(&d);
    vplMaterialDef own = vplDefaultMaterialDef();
    own.name = "paint";
    assert_int_equal(vplScene_AddMaterial(d.scene, &own, NULL), VPL_SUCCESS);
    for (int i = 0; i < 3; i++) {
        int mesh = -1;
        assert_int_equal(vplScene_LoadObj(d.scene, "tests/data/obj/square.obj", &mesh), VPL_SUCCESS);
        assert_int_equal(mesh, i);
        assert_int_equal(vplScene_GetMesh(d.scene, i)->materials[0], i + 1);
    }
    static const char* const names[] = {"paint", "square.obj:paint", "square.obj(2):paint",
                                        "square.obj(3):paint"};
    assert_int_equal(vplScene_GetMaterialCount(d.scene), 4);
    for (int i = 0; i < 4; i++) {
        assert_string_equal(vplScene_GetMaterial(d.scene, i)->name, names[i]);
    }
    own.name = "white";
    assert_int_equal(vplScene_AddMaterial(d.scene, &own, NULL), VPL_SUCCESS);
    assert_string_equal(d.said, "");
    closeDesk(&d);
}

// ---- JSON

static vplScene* loadJson(Desk* d, const char* objects)
{
    char path[96], text[2000];
    vplScene* scene = NULL;
    snprintf(path, sizeof path, "%s/a.json", d->folder);
    snprintf(text, sizeof text,
             "{\"camera\": {\"eye\": [0, 0, 5], \"target\": [0, 0, 0]},\n"
             "\"materials\": {\"red\": {}, \"paint\": {}},\n\"objects\": [%s]}",
             objects);
    writeText(path, text);
    d->said[0] = 0;
    vplResult result = vplScene_Load(d->context, path, &scene);
    unlink(path);
    assert_true((result == VPL_SUCCESS) == (scene != NULL));
    return scene;
}

TEST_ALONE(ObjectsShareTheMeshOfOneFile)
{
    Desk d;
    openDesk(&d);
    writeText(d.mtl, "newmtl red\nKd 1 0 0\nKe 3\n");
    writeText(d.obj, "mtllib a.mtl\nusemtl red\n" TRIANGLE);
    vplScene* scene =
        loadJson(&d, "{\"type\": \"mesh\", \"file\": \"a.obj\"},\n"
                     "{\"type\": \"mesh\", \"file\": \"a.obj\", \"material\": \"paint\", \"name\": \"n\"},\n"
                     "{\"type\": \"quad\", \"material\": \"red\"},\n"
                     "{\"type\": \"mesh\", \"file\": \"./a.obj\", \"translate\": [0, 7, 0], \"scale\": 2},\n"
                     "{\"type\": \"mesh\", \"file\": \"a.obj\", \"material\": \"red\"}");
    assert_non_null(scene);
    assert_true(vplScene_GetMeshCount(scene) == 2 && vplScene_GetObjectCount(scene) == 5);
    assert_true(vplScene_GetMaterialCount(scene) == 4 && d.said[0] == 0);
    static const int meshes[] = {0, 0, 0, 1, 0}, materials[] = {-1, 1, 0, -1, 0};
    for (int i = 0; i < 5; i++) {
        const vplObjectDef* object = vplScene_GetObject(scene, i);
        assert_int_equal(object->type, i == 2 ? VPL_OBJECT_QUAD : VPL_OBJECT_MESH);
        assert_int_equal(object->mesh, meshes[i]);
        assert_int_equal(object->material, materials[i]);
    }
    assert_string_equal(vplScene_GetObject(scene, 1)->name, "n");
    assert_true(vplScene_GetObject(scene, 3)->transform.m[13] == 7 &&
                vplScene_GetObject(scene, 3)->transform.m[0] == 2);
    assert_string_equal(vplScene_GetMaterial(scene, 2)->name, "a.obj:red");
    assertColour(vplScene_GetMaterial(scene, 2)->emission, 3, 3, 3);
    assert_int_equal(vplScene_GetMesh(scene, 0)->materials[0], 2);
    assert_int_equal(vplScene_GetMesh(scene, 1)->materials[0], 3);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

TEST_ALONE(MaterialsOfMeshesAreNotTheScenes)
{
    Desk d;
    openDesk(&d);
    writeText(d.obj, "usemtl wood\n" TRIANGLE);
    assert_null(loadJson(&d, "{\"type\": \"mesh\", \"file\": \"a.obj\"},\n"
                             "{\"type\": \"quad\", \"material\": \"a.obj:wood\"}"));
    assert_non_null(strstr(d.said, "a.json:4:30: objects[1].material is \"a.obj:wood\""));
    closeDesk(&d);
}

TEST_ALONE(DamageInAMeshIsNamedByItsOwnFile)
{
    Desk d;
    openDesk(&d);
    writeText(d.obj, "v 0 0 0\nv 1 0 x\n");
    assert_null(loadJson(&d, "{\"type\": \"mesh\", \"file\": \"a.obj\"}"));
    assert_non_null(strstr(d.said, "a.obj:2:7: found \"x\", expected a coordinate\n"));
    assert_int_equal(countOf(d.said, "\n"), 1);
    closeDesk(&d);
}

// ---- OBJ files as scenes

TEST_ALONE(AnObjAloneGetsACameraAGroundAndLamps)
{
    static const char* const texts[] = {
        TRIANGLE,
        "v 1000 -500 3000\nv 1001 -500 3000\nv 1000 -499 3003\nv 1000 -502 2999\nf 1 2 3 4\nf 1 2 4\n",
        "v -1e-9 0 0\nv 1e-9 0 0\nv 0 1e-9 2e-9\nf 1 2 3\n",
        "v -1e9 0 5e9\nv 1e9 0 0\nv 0 1e9 -1e9\nf 1 2 3\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        Desk d;
        vplScene* scene = NULL;
        openDesk(&d);
        writeText(d.obj, texts[i]);
        assert_int_equal(vplScene_Load(d.context, d.obj, &scene), VPL_SUCCESS);
        assert_int_equal(countOf(d.said, "warning: "), 4);
        assert_int_equal(countOf(d.said, "a.obj: the file has no camera; one looks from ("), 1);
        assert_int_equal(countOf(d.said, "a.obj: it stands on a grey ground of "), 1);
        assert_int_equal(countOf(d.said, "a.obj: nothing emits light; a square "), 2);
        static const char* const names[] = {"a.obj", "ground", "key lamp", "fill lamp"};
        assert_true(vplScene_GetEmitterCount(scene) == 0 && vplScene_GetObjectCount(scene) == 4);
        for (int k = 0; k < 4; k++) {
            assert_string_equal(vplScene_GetObject(scene, k)->name, names[k]);
        }
        vplScene_Destroy(scene);
        closeDesk(&d);
    }
}

TEST_ALONE(AnObjThatEmitsGetsNoLight)
{
    Desk d;
    vplScene* scene = NULL;
    openDesk(&d);
    assert_int_equal(vplScene_Load(d.context, "tests/data/obj/everything.obj", &scene), VPL_SUCCESS);
    assert_true(vplScene_GetEmitterCount(scene) == 0 && vplScene_GetObjectCount(scene) == 2);
    assert_int_equal(countOf(d.said, "warning: "), 2);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

TEST_ALONE(BoundsThatNoCameraCanSeeAreRefused)
{
    static const char* const texts[][2] = {
        {"v -1e15 0 0\nv 1e15 0 0\nv 0 1e15 0\nf 1 2 3\n", "a.obj:1:1: found bounds around (0, 5e+14, 0)"},
        {"v 1e14 0 0\nv 1e14 1e-30 0\nv 1e14 0 1e-30\nf 1 2 3\n", "its target equals the eye"}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        Desk d;
        vplScene* scene = NULL;
        openDesk(&d);
        writeText(d.obj, texts[i][0]);
        assert_int_equal(vplScene_Load(d.context, d.obj, &scene), VPL_PARSE_ERROR);
        if (strstr(d.said, texts[i][1]) == NULL) {
            fail_msg("%s instead of %s", d.said, texts[i][1]);
        }
        assert_null(scene);
        closeDesk(&d);
    }
}

// The file extension decides, in upper case, too; files with other extensions are read as JSON.
TEST_ALONE(TheEndingOfThePathDecides)
{
    Desk d;
    vplScene* scene = NULL;
    char path[128];
    openDesk(&d);
    snprintf(path, sizeof path, "%s/B.OBJ", d.folder);
    writeText(path, TRIANGLE);
    assert_int_equal(vplScene_Load(d.context, path, &scene), VPL_SUCCESS);
    vplScene_Destroy(scene);
    unlink(path);
    scene = NULL;
    snprintf(path, sizeof path, "%s/obj", d.folder);
    writeText(path, TRIANGLE);
    assert_int_equal(vplScene_Load(d.context, path, &scene), VPL_PARSE_ERROR);
    unlink(path);
    assert_null(scene);
    closeDesk(&d);
}
