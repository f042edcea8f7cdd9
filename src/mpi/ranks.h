// SPDX-License-Identifier: MIT
// What the processes of an MPI job share: messages that are counted, the scene, and work that is handed out.
#ifndef VPL_MPI_RANKS_H
#define VPL_MPI_RANKS_H

#include "cli/cli.h"

#include <mpi.h>

// What one rank did. All fields are doubles, so that they travel as one array.
typedef struct RankStats {
    double units, busyMs, cpuMs; // units of work that were made; time in them; processor time of the process
    double messages, bytes;      // sent
    double peakBytes;            // of the context
    double plannedBytes;         // that the plan foretold; 0: unknown
    double waitMs;               // ms in exchanges of the team
} RankStats;

// The options that vpl-mpi has beside those of vpl.
typedef struct MpiOptions {
    double grace;       // seconds that units under way may take after SIGTERM
    bool shared;        // every rank reads the scene from disk by itself
    bool rankZeroWaits; // rank 0 only hands out
    int bands;          // of a picture; 0: by the number of ranks
    bool pingPong;
} MpiOptions;

typedef struct Ranks {
    int rank, count;
    MpiOptions options;
    RankStats stats; // of this rank
    RankStats* all;  // of every rank, at rank 0 after runWork
    const Arguments* arguments;
    vplContext* context;
    char speaker[64];      // the name of this rank in sentences
    MPI_Request* requests; // of an exchange of the team
} Ranks;

// ---- messages (ranks.c)

enum { TAG_WORK = 1, TAG_STOP, TAG_RESULT, TAG_BYTES, TAG_FAIL, TAG_BYE, TAG_TEAM };

// Copies bytes of rank 0 to all ranks. At other ranks *bytes is allocated with malloc and *size is set. Returns false, at
// all ranks, where one has no memory for them.
bool shareBytes(Ranks* ranks, uint8_t** bytes, size_t* size);

// Gives all ranks the number that rank 0 has.
int shareNumber(Ranks* ranks, int number);

// The largest number of all ranks.
int largestNumber(Ranks* ranks, int number);

// Fills in the statistics of this rank, and collects those of all at rank 0. An exit code for all ranks.
int collectStats(Ranks* ranks);

// ---- the team (team.c)

// Makes all ranks share the rows of form factors, where the options ask for radiosity. An exit code for all ranks.
int formTeam(Ranks* ranks);

// From now on each rank works for itself.
void dissolveTeam(Ranks* ranks);

// ---- the scene (scene.c)

// Reads the scene at rank 0 and sends it with all files that it names; a code for all ranks, 0: *sceneOut is there.
int shareScene(Ranks* ranks, vplContext* context, vplScene** sceneOut);

// ---- units of work, handed out one by one (work.c)

// Makes unit `index` at any rank; *bytesOut is allocated with malloc. `progress` must be called now and then.
typedef vplResult MakeUnit(void* user, int index, uint8_t** bytesOut, size_t* sizeOut);

// Takes a finished unit at rank 0; an exit code.
typedef int TakeUnit(void* user, int index, const uint8_t* bytes, size_t size);

typedef struct Work {
    const char* name; // of units, for sentences: "pieces"
    int count;
    const bool* done; // of each unit, at rank 0: it needs not be made
    MakeUnit* make;
    TakeUnit* take;
    void* user;
    Progress* progress;     // at rank 0
    const char* checkpoint; // the file that keeps finished units; NULL: they are lost when the job ends early
    struct Desk* desk;      // of the run under way
} Work;

// Makes all units, whoever is free. Returns the same exit code at all ranks.
int runWork(Ranks* ranks, Work* work);

// For vplRenderOptions.progress, with the Work as user: serves messages, and returns false when the unit shall end.
vplProgressFcn attendWork;

// ---- files of finished units (journal.c)

typedef struct Journal {
    int file; // -1: none
    const char* path;
    int64_t size; // bytes that are whole
    bool failed;  // a write failed, which was told; nothing more is written
} Journal;

// Takes the finished units of a file into account, and sets how many of its bytes are whole units. An exit code.
typedef int ReadUnits(void* user, const char* path, const uint8_t* bytes, size_t size, size_t* keptOut);

// Reads the file of --resume, and opens that of --checkpoint, which then has what was kept, or else the text `title`
// (NULL: nothing). An exit code; without these options nothing is done.
int openJournal(Journal* journal, vplContext* context, const Arguments* arguments, const char* title,
                ReadUnits* read, void* user);

// Adds a unit. Where the disk is full the file keeps the units before; false after complaining.
bool appendJournal(Journal* journal, const void* bytes, size_t size);

// False after complaining where the file is not safely on disk.
bool closeJournal(Journal* journal);

// ---- commands

int renderPieces(Ranks* ranks, vplScene* scene); // picture.c
int renderFrames(Ranks* ranks, vplScene* scene); // frames.c
int bakePatches(Ranks* ranks, vplScene* scene);  // bake.c
int measureTradeoff(Ranks* ranks);               // tradeoff.c
int measureMessages(Ranks* ranks);               // ping_pong.c

// Prints what the ranks did, as -v and --stats ask for it; `hash` is the picture's. An exit code (report.c).
int reportRanks(const Ranks* ranks, double wallMs, uint64_t hash);

#endif
