// SPDX-License-Identifier: MIT
// What the members of a team (vplContext_SetTeam) send each other. All members call these functions in the same order. A
// member whose part of the work fails passes its result to the next call, which gives the worst result of all to every
// member; after that nothing is sent until the team is set anew. So no member waits for one that has given up.
#ifndef VPL_BASE_TEAM_H
#define VPL_BASE_TEAM_H

#include "base/arena.h"

static inline bool vplHasTeam(const vplContext* context)
{
    return context->team.count > 1;
}

// Gives every member the worst result of all. Without a team it is `mine`.
vplResult vplTeam_Agree(vplContext* context, vplResult mine);

// Buffers of messages, from an arena.
typedef struct vplTeamMail {
    vplArena* arena;
    uint8_t *send, *received;             // to all members, one after the other; from all
    size_t sendCapacity, receiveCapacity; // bytes
    size_t *sendBytes, *receivedBytes;    // of each member
} vplTeamMail;

// Sends sendBytes[m] bytes to each member m, and fills in what all members sent to this one.
vplResult vplTeam_Exchange(vplContext* context, vplResult mine, vplTeamMail* mail);

// The first row of a member from `first` on: row i of a table belongs to member i % members.
static inline int vplTeam_FirstRow(int first, int member, int members)
{
    return first + (member - first % members + members) % members;
}

// Rows of a table.
typedef struct vplTeamRows {
    void* values; // from row 0 on
    size_t bytes; // of a row
    int first, end;
} vplTeamRows;

// Allocates buffers, for vplTeam_ShareRows of at most so many rows where rowBytes is not 0.
vplTeamMail vplTeamMail_Alloc(vplContext* context, vplArena* arena, int rows, size_t rowBytes);

// Gives all members the rows that each of them has. All must have agreed since the last step that could fail, but for `mine`.
vplResult vplTeam_ShareRows(vplContext* context, vplResult mine, vplTeamMail* mail, const vplTeamRows* rows);

#endif
