/* The C side of the benchmark: the library that mavgen generates, used as its headers document.
 *
 *   peer live|tlog|signed FILE COUNT     every byte through mavlink_parse_char
 *   peer buffer FILE COUNT               16 KiB at a time through mavlink_parse_buffer: our headers only
 *   peer encode COUNT                    ATTITUDE through mavlink_msg_attitude_pack_chan
 *
 * The file is read into memory first, a tenth of the work is done as a warm-up, and only then is the
 * clock started. Prints the number of messages, the seconds, and a sum of what was read, so that the
 * compiler may leave nothing out. decode.h is generated beside the headers: `read_three` decodes the
 * workload's messages and reads three fields of each, `decode_all` decodes any message of the dialect.
 */
#include <mavlink.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "decode.h"

enum { STAMP = 8 };

typedef struct {
    const uint8_t *bytes;
    size_t size;
} buffer_t;

typedef struct {
    long messages;
    double sum;
} tally_t;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static buffer_t read_file(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        perror(path);
        exit(1);
    }
    size_t size = (size_t)ftell(file);
    uint8_t *bytes = malloc(size);
    rewind(file);
    if (bytes == NULL || fread(bytes, 1, size, file) != size) {
        perror(path);
        exit(1);
    }
    fclose(file);
    return (buffer_t){bytes, size};
}

/* A stream of packets, decoded into structs, three fields read from each. */
static tally_t live(buffer_t input, long count) {
    mavlink_message_t message;
    mavlink_status_t status;
    tally_t tally = {0, 0.0};
    for (size_t at = 0; at < input.size && tally.messages < count; at++) {
        if (mavlink_parse_char(MAVLINK_COMM_0, input.bytes[at], &message, &status)) {
            tally.sum += read_three(&message);
            tally.messages++;
        }
    }
    return tally;
}

#ifdef MAVLINK_PARSER_H
/* The same in chunks. */
static tally_t buffer(buffer_t input, long count) {
    mavlink_parser_t parser;
    mavlink_message_t message;
    tally_t tally = {0, 0.0};
    mavlink_parser_init(&parser);
    for (size_t at = 0; at < input.size && tally.messages < count; at += 16384) {
        const uint8_t *bytes = input.bytes + at;
        size_t size = input.size - at < 16384 ? input.size - at : 16384;
        while (tally.messages < count && mavlink_parse_buffer(&parser, &bytes, &size, &message)) {
            tally.sum += read_three(&message);
            tally.messages++;
        }
    }
    return tally;
}
#endif

/* A telemetry log, every message decoded into its struct, all fields. */
static tally_t tlog(buffer_t input, long count) {
    mavlink_message_t message;
    mavlink_status_t status;
    tally_t tally = {0, 0.0};
    size_t at = 0;
    while (at + STAMP < input.size && tally.messages < count) {
        uint64_t stamp = 0;
        for (int index = 0; index < STAMP; index++) {
            stamp = stamp << 8 | input.bytes[at++];
        }
        while (at < input.size && !mavlink_parse_char(MAVLINK_COMM_0, input.bytes[at++], &message, &status)) {
        }
        decode_all(&message);
        tally.sum += (double)(stamp & 0xff);
        tally.messages++;
    }
    return tally;
}

/* Signed packets: framing, checksum and signature, no struct made. */
static tally_t verify(buffer_t input, long count) {
    static mavlink_signing_t signing;
    static mavlink_signing_streams_t streams;
    mavlink_message_t message;
    mavlink_status_t status;
    tally_t tally = {0, 0.0};
    memset(&streams, 0, sizeof streams);
    memset(&signing, 0, sizeof signing);
    memcpy(signing.secret_key, signing_key, sizeof signing.secret_key);
    mavlink_get_channel_status(MAVLINK_COMM_0)->signing = &signing;
    mavlink_get_channel_status(MAVLINK_COMM_0)->signing_streams = &streams;
    for (size_t at = 0; at < input.size && tally.messages < count; at++) {
        if (mavlink_parse_char(MAVLINK_COMM_0, input.bytes[at], &message, &status)) {
            tally.messages++;
        }
    }
    return tally;
}

/* Seven changing fields to the bytes of an ATTITUDE packet. */
static tally_t encode(buffer_t input, long count) {
    mavlink_message_t message;
    uint8_t packet[MAVLINK_MAX_PACKET_LEN];
    tally_t tally = {0, 0.0};
    (void)input;
    for (long index = 0; index < count; index++) {
        float angle = (float)(index & 4095) * 0.0007f + 0.1f;
        mavlink_msg_attitude_pack_chan(1, 1, MAVLINK_COMM_0, &message, (uint32_t)index, angle, angle + 1, angle + 2,
                                       angle + 3, angle + 4, angle + 5);
        uint16_t size = mavlink_msg_to_send_buffer(packet, &message);
        __asm__ volatile("" : : "r"(packet) : "memory");
        tally.sum += size;
        tally.messages++;
    }
    return tally;
}

int main(int argc, char **argv) {
    bool encoding = argc == 3 && strcmp(argv[1], "encode") == 0;
    if (!encoding && argc != 4) {
        fprintf(stderr, "usage: peer live|tlog|signed FILE COUNT, or peer encode COUNT\n");
        return 2;
    }
    buffer_t input = encoding ? (buffer_t){NULL, 0} : read_file(argv[2]);
    long count = atol(argv[argc - 1]);
    tally_t (*work)(buffer_t, long) = encoding                        ? encode
                                      : strcmp(argv[1], "live") == 0 ? live
#ifdef MAVLINK_PARSER_H
                                      : strcmp(argv[1], "buffer") == 0 ? buffer
#endif
                                      : strcmp(argv[1], "tlog") == 0 ? tlog
                                                                     : verify;
    work(input, count / 10 + 1);
    mavlink_reset_channel_status(MAVLINK_COMM_0);
    double start = seconds();
    tally_t tally = work(input, count);
    double took = seconds() - start;
    printf("%ld %.9f %g\n", tally.messages, took, tally.sum);
    return 0;
}
