// SPDX-License-Identifier: MIT
#include "base/team.h"

#include <string.h>

// What comes before all other bytes of an exchange.
typedef struct Header {
    uint64_t result, bytes;
} Header;

enum { MOST_MEMBERS = 1 << 16 };

vplResult vplContext_SetTeam(vplContext* context, const vplTeam* team)
{
    REQUIRE(NULL, context);
    Header* headers = NULL;
    if (team != NULL) {
        CHECK_POINTERS(context, team->exchange);
        if (team->count < 1 || team->count > MOST_MEMBERS || team->index < 0 || team->index >= team->count) {
            return vplFail(context, VPL_INVALID_ARGUMENT,
                           "vplTeam has member %d of %d, must be in [0, count) of [1, %d]", team->index,
                           team->count, (int)MOST_MEMBERS);
        }
        headers = vplAlloc(context, 2 * (size_t)team->count, sizeof *headers + sizeof(size_t));
        if (headers == NULL) {
            return VPL_OUT_OF_MEMORY;
        }
    }
    vplFree(context, context->teamRoom);
    context->teamRoom = headers;
    context->team = team != NULL ? *team : (vplTeam){.count = 0};
    context->teamResult = VPL_SUCCESS;
    return VPL_SUCCESS;
}

// Ends the exchanges of a team where a member failed.
static vplResult judge(vplContext* context, vplResult mine, vplResult worst, int member)
{
    context->teamResult = worst;
    if (worst != VPL_SUCCESS && worst != VPL_CANCELLED && mine != worst) {
        return vplFail(context, worst, "process %d of %d failed: %s", member, context->team.count,
                       vplResult_GetName(worst));
    }
    return worst;
}

// Sends the result and how many bytes follow. receivedBytes is filled in where it is not NULL.
static vplResult exchangeHeaders(vplContext* context, vplResult mine, const size_t* sendBytes,
                                 size_t* receivedBytes)
{
    const vplTeam* t = &context->team;
    Header *out = context->teamRoom, *in = out + t->count;
    size_t *outBytes = (size_t*)(in + t->count), *inBytes = outBytes + t->count;
    if (context->teamResult != VPL_SUCCESS) {
        return context->teamResult;
    }
    for (int m = 0; m < t->count; m++) {
        out[m] = (Header){(uint64_t)mine, sendBytes != NULL ? sendBytes[m] : 0};
        outBytes[m] = inBytes[m] = sizeof(Header);
    }
    t->exchange(t->user, out, outBytes, in, inBytes);
    int worst = 0;
    for (int m = 0; m < t->count; m++) {
        worst = in[m].result > in[worst].result ? m : worst;
        if (receivedBytes != NULL) {
            receivedBytes[m] = (size_t)in[m].bytes;
        }
    }
    return judge(context, mine, (vplResult)in[worst].result, worst);
}

vplResult vplTeam_Agree(vplContext* context, vplResult mine)
{
    return vplHasTeam(context) ? exchangeHeaders(context, mine, NULL, NULL) : mine;
}

vplResult vplTeam_Exchange(vplContext* context, vplResult mine, vplTeamMail* mail)
{
    const vplTeam* t = &context->team;
    size_t all = 0;
    TRY(exchangeHeaders(context, mine, mail->sendBytes, mail->receivedBytes));
    for (int m = 0; m < t->count; m++) {
        all += mail->receivedBytes[m];
    }
    TRY(vplTeam_Agree(context,
                      vplArena_Reserve(mail->arena, &mail->received, &mail->receiveCapacity, all, 1)));
    t->exchange(t->user, mail->send, mail->sendBytes, mail->received, mail->receivedBytes);
    return VPL_SUCCESS;
}

// ---- rows

// How many of the rows in [first, end) are a member's.
static size_t countRows(int first, int end, int member, int members)
{
    const int before = (first - member + members - 1) / members, all = (end - member + members - 1) / members;
    return (size_t)(all - before);
}

vplTeamMail vplTeamMail_Alloc(vplContext* context, vplArena* arena, int rows, size_t rowBytes)
{
    const size_t members = (size_t)context->team.count;
    const size_t each = sizeof(uint64_t) + ((size_t)rows / members + 1) * rowBytes;
    vplTeamMail mail = {.arena = arena,
                        .sendBytes = vplArena_AllocZero(arena, members, sizeof *mail.sendBytes),
                        .receivedBytes = vplArena_AllocZero(arena, members, sizeof *mail.receivedBytes)};
    mail.sendCapacity = mail.receiveCapacity = rowBytes > 0 ? members * each : 0;
    mail.send = rowBytes > 0 ? vplArena_Alloc(arena, mail.sendCapacity, 1) : NULL;
    mail.received = rowBytes > 0 ? vplArena_Alloc(arena, mail.receiveCapacity, 1) : NULL;
    return mail;
}

// Writes the member's result and its rows once for each member.
static void writeRows(const vplTeam* t, vplResult mine, vplTeamMail* mail, const vplTeamRows* rows)
{
    const uint64_t result = (uint64_t)mine;
    uint8_t* to = mail->send;
    for (int m = 0; m < t->count; m++) {
        const uint8_t* start = to;
        memcpy(to, &result, sizeof result);
        to += sizeof result;
        for (int i = vplTeam_FirstRow(rows->first, t->index, t->count); i < rows->end; i += t->count) {
            memcpy(to, (const uint8_t*)rows->values + (size_t)i * rows->bytes, rows->bytes);
            to += rows->bytes;
        }
        mail->sendBytes[m] = (size_t)(to - start);
        mail->receivedBytes[m] = sizeof result + rows->bytes * countRows(rows->first, rows->end, m, t->count);
    }
}

vplResult vplTeam_ShareRows(vplContext* context, vplResult mine, vplTeamMail* mail, const vplTeamRows* rows)
{
    const vplTeam* t = &context->team;
    uint64_t worst = 0;
    int from = 0;
    if (context->teamResult != VPL_SUCCESS) {
        return context->teamResult;
    }
    writeRows(t, mine, mail, rows);
    t->exchange(t->user, mail->send, mail->sendBytes, mail->received, mail->receivedBytes);
    const uint8_t* at = mail->received;
    for (int m = 0; m < t->count; m++) {
        uint64_t result;
        memcpy(&result, at, sizeof result);
        at += sizeof result;
        from = result > worst ? m : from;
        worst = result > worst ? result : worst;
        for (int i = vplTeam_FirstRow(rows->first, m, t->count); i < rows->end; i += t->count) {
            memcpy((uint8_t*)rows->values + (size_t)i * rows->bytes, at, rows->bytes);
            at += rows->bytes;
        }
    }
    return judge(context, mine, (vplResult)worst, from);
}
