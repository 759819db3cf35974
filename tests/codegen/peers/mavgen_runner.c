/* The conformance runner of the C library that mavgen generates; DIALECT_HEADER names its header. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAVLINK_USE_MESSAGE_INFO
#include DIALECT_HEADER

static const unsigned sizes[] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8}; /* by mavlink_message_type_t */

static unsigned from_hex(const char *text, uint8_t *data)
{
    unsigned count = 0;
    for (unsigned value; sscanf(text + 2 * count, "%2x", &value) == 1; count++)
        data[count] = (uint8_t)value;
    return count;
}

static void print_hex(const uint8_t *data, unsigned length)
{
    while (length--)
        printf("%02x", *data++);
}

static void pack(mavlink_message_t message, const mavlink_signing_t *received, int has_key)
{
    const mavlink_msg_entry_t *entry = mavlink_get_msg_entry(message.msgid);
    mavlink_signing_t signing = *received;
    mavlink_status_t status = {0};
    uint8_t data[MAVLINK_MAX_PACKET_LEN];
    status.current_tx_seq = message.seq;
    if (message.magic == MAVLINK_STX_MAVLINK1) {
        status.flags = MAVLINK_STATUS_FLAG_OUT_MAVLINK1;
    } else if (has_key && (message.incompat_flags & MAVLINK_IFLAG_SIGNED)) {
        signing.timestamp = 0;
        memcpy(&signing.timestamp, message.signature + 1, 6);
        signing.link_id = message.signature[0];
        signing.flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
        status.signing = &signing;
    }
    mavlink_finalize_message_buffer(&message, message.sysid, message.compid, &status, entry->min_msg_len,
                                    entry->max_msg_len, entry->crc_extra);
    print_hex(data, mavlink_msg_to_send_buffer(data, &message));
}

static void show(const mavlink_message_t *message, const mavlink_signing_t *signing, int has_key)
{
    const mavlink_message_info_t *info = mavlink_get_message_info(message);
    int is_v2 = message->magic == MAVLINK_STX;
    printf("packet %s %u %d %u %u %u %d", info->name, message->msgid, is_v2 ? 2 : 1, message->seq, message->sysid,
           message->compid, is_v2 && (message->incompat_flags & MAVLINK_IFLAG_SIGNED));
    for (unsigned i = 0; i < info->num_fields; i++) {
        const mavlink_field_info_t *field = &info->fields[i];
        printf(" %s=", field->name);
        print_hex((const uint8_t *)_MAV_PAYLOAD(message) + field->wire_offset,
                  sizes[field->type] * (field->array_length ? field->array_length : 1));
    }
    printf("\npacked %s ", info->name);
    pack(*message, signing, has_key);
    printf("\n");
}

int main(void)
{
    static char line[65536], name[256], key[80], now[32], hex[65536];
    static uint8_t data[32768];
    while (fgets(line, sizeof line, stdin)) {
        mavlink_message_t buffer = {0}, message;
        mavlink_status_t state = {0}, status;
        mavlink_signing_t signing = {0};
        mavlink_signing_streams_t streams = {0};
        if (sscanf(line, "%255s %79s %31s %65535s", name, key, now, hex) != 4)
            return 1;
        int has_key = key[0] != '-';
        if (has_key) {
            from_hex(key, signing.secret_key);
            signing.timestamp = strtoull(now, NULL, 10);
            state.signing = &signing;
            state.signing_streams = &streams;
        }
        unsigned length = from_hex(hex, data);
        for (unsigned i = 0; i < length; i++) {
            uint8_t result = mavlink_frame_char_buffer(&buffer, &state, data[i], &message, &status);
            if (result == MAVLINK_FRAMING_OK && mavlink_get_message_info(&message))
                show(&message, &signing, has_key);
            if (result == MAVLINK_FRAMING_BAD_CRC || result == MAVLINK_FRAMING_BAD_SIGNATURE) {
                /* as mavlink_parse_char does */
                state.parse_state = MAVLINK_PARSE_STATE_IDLE;
                if (data[i] == MAVLINK_STX) {
                    state.parse_state = MAVLINK_PARSE_STATE_GOT_STX;
                    buffer.len = 0;
                    mavlink_start_checksum(&buffer);
                }
            }
        }
        printf("end %s\n", name);
    }
    return 0;
}
