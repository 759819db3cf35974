/* The conformance runner of the C library (see conformance/README.md).
 *
 * messages.inc has a line MESSAGE(NAME, name) for each message. The argument is the size of the chunks: 0 parses byte
 * by byte with mavlink_parse(). */
#define MAVLINK_USE_MESSAGE_INFO
#define MAVLINK_NO_CHANNELS
#include <stdio.h>
#include <stdlib.h>

#include DIALECT_HEADER

static char line[1 << 20];
static uint8_t input[1 << 19];
static mavlink_signing_streams_t streams;
static mavlink_signing_t signing;

static size_t read_hex(const char *text, uint8_t *bytes)
{
    size_t count = 0;
    unsigned int byte;
    while (sscanf(text + 2 * count, "%2x", &byte) == 1) {
        bytes[count++] = (uint8_t)byte;
    }
    return count;
}

static void print_value(const uint8_t *value, size_t size)
{
    const uint16_t one = 1;
    const int little = *(const uint8_t *)&one == 1;
    size_t i;
    for (i = 0; i < size; i++) {
        printf("%02x", value[little ? i : size - 1 - i]);
    }
}

static void print_fields(const mavlink_message_info_t *info, const void *fields)
{
    static const uint8_t sizes[] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    unsigned int i, k;
    for (i = 0; i < info->num_fields; i++) {
        const mavlink_field_info_t *field = &info->fields[i];
        const unsigned int count = field->array_length > 0 ? field->array_length : 1;
        printf(" %s=", field->name);
        for (k = 0; k < count; k++) {
            print_value((const uint8_t *)fields + field->structure_offset + k * sizes[field->type],
                        sizes[field->type]);
        }
    }
}

static void print_packed(const mavlink_message_t *msg, const char *name)
{
    uint8_t bytes[MAVLINK_MAX_PACKET_LEN];
    const uint16_t length = mavlink_msg_to_send_buffer(bytes, msg);
    uint16_t i;
    printf("packed %s ", name);
    for (i = 0; i < length; i++) {
        printf("%02x", bytes[i]);
    }
    printf("\n");
}

/* Returns the status of a link that sends like the sender of a message. */
static mavlink_status_t sender(const mavlink_message_t *msg, mavlink_signing_t *key, int verified)
{
    mavlink_status_t status;
    int i;
    memset(&status, 0, sizeof(status));
    status.current_tx_seq = msg->seq;
    status.flags = msg->magic == MAVLINK_STX_MAVLINK1 ? MAVLINK_STATUS_FLAG_OUT_MAVLINK1 : 0;
    if (verified && (msg->incompat_flags & MAVLINK_IFLAG_SIGNED) != 0) {
        *key = signing;
        key->flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
        key->link_id = msg->signature[0];
        key->timestamp = 0;
        for (i = 6; i > 0; i--) {
            key->timestamp = key->timestamp << 8 | msg->signature[i];
        }
        status.signing = key;
    }
    return status;
}

#define MESSAGE(NAME, name)                                                                           \
    case MAVLINK_MSG_ID_##NAME: {                                                                     \
        mavlink_##name##_t fields;                                                                    \
        mavlink_msg_##name##_decode(msg, &fields);                                                    \
        print_fields(info, &fields);                                                                  \
        mavlink_msg_##name##_encode_status(msg->sysid, msg->compid, &status, &packed, &fields);       \
        break;                                                                                        \
    }

static void print_packet(const mavlink_message_t *msg, int verified)
{
    const mavlink_message_info_t *info = mavlink_get_message_info(msg);
    mavlink_signing_t key;
    mavlink_status_t status = sender(msg, &key, verified);
    mavlink_message_t packed;
    printf("packet %s %u %d %u %u %u %d", info->name, (unsigned int)msg->msgid,
           msg->magic == MAVLINK_STX_MAVLINK1 ? 1 : 2, msg->seq, msg->sysid, msg->compid,
           (msg->incompat_flags & MAVLINK_IFLAG_SIGNED) != 0);
    switch (msg->msgid) {
#include "messages.inc"
    default:
        exit(1);
    }
    printf("\n");
    print_packed(&packed, info->name);
}

static void run(const char *name, const uint8_t *bytes, size_t length, size_t chunk)
{
    static mavlink_parser_t parser;
    mavlink_message_t msg;
    mavlink_parser_init(&parser);
    parser.status.signing = signing.flags != 0 ? &signing : NULL;
    parser.status.signing_streams = &streams;
    while (length > 0) {
        size_t left = chunk == 0 ? 1 : (chunk < length ? chunk : length);
        uint8_t framing = chunk == 0 ? mavlink_parse(&parser, *bytes, &msg) : (uint8_t)MAVLINK_FRAMING_INCOMPLETE;
        const uint8_t *next = bytes + (chunk == 0 ? 1 : 0);
        size_t rest = chunk == 0 ? 0 : left;
        if (framing == MAVLINK_FRAMING_OK) {
            print_packet(&msg, signing.flags != 0);
        }
        while ((framing = mavlink_parse_buffer(&parser, &next, &rest, &msg)) != MAVLINK_FRAMING_INCOMPLETE) {
            if (framing == MAVLINK_FRAMING_OK) {
                print_packet(&msg, signing.flags != 0);
            }
        }
        bytes += left;
        length -= left;
    }
    printf("end %s good=%u bad_crc=%u bad_signature=%u unknown=%u\n", name, (unsigned int)parser.counters.good,
           (unsigned int)parser.counters.bad_crc, (unsigned int)parser.counters.bad_signature,
           (unsigned int)parser.counters.unknown);
}

int main(int argc, char **argv)
{
    const size_t chunk = argc > 1 ? (size_t)atoi(argv[1]) : 64;
    while (fgets(line, sizeof(line), stdin) != NULL) {
        const char *name = strtok(line, " "), *key = strtok(NULL, " "), *now = strtok(NULL, " ");
        const char *text = strtok(NULL, " \n");
        const size_t length = text == NULL ? 0 : read_hex(text, input);
        memset(&signing, 0, sizeof(signing));
        memset(&streams, 0, sizeof(streams));
        if (key[0] != '-') {
            signing.flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
            read_hex(key, signing.secret_key);
            signing.timestamp = now[0] == '-' ? 0 : strtoull(now, NULL, 10);
        }
        run(name, input, length, chunk);
    }
    return 0;
}
