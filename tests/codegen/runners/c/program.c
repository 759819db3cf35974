/* A program in the style of those for the official C library: heartbeat and attitude, sent and received. */
#define MAVLINK_USE_CONVENIENCE_FUNCTIONS
#define MAVLINK_USE_MESSAGE_INFO
#include <stdio.h>
#include <stdlib.h>

#include "mavlink_types.h"

#define CHECK(condition) ((condition) ? (void)0 : (printf("line %d: %s\n", __LINE__, #condition), exit(1)))
#define MAVLINK_ASSERT(condition) CHECK(condition)

static mavlink_system_t mavlink_system = {1, 1};
static void comm_send_ch(mavlink_channel_t chan, uint8_t byte);
#include DIALECT_HEADER

static mavlink_message_t received;
static unsigned int count;

static void comm_send_ch(mavlink_channel_t chan, uint8_t byte)
{
    mavlink_status_t status;
    count += mavlink_parse_char((uint8_t)(chan + 1), byte, &received, &status);
}

#include TESTSUITE_HEADER

static void test_heartbeat(void)
{
    mavlink_heartbeat_t heartbeat, decoded;
    mavlink_message_t msg;
    uint8_t buffer[MAVLINK_MAX_PACKET_LEN];
    memset(&heartbeat, 0, sizeof(heartbeat));
    heartbeat.type = MAV_TYPE_QUADROTOR;
    heartbeat.system_status = MAV_STATE_ACTIVE;
    CHECK(mavlink_msg_heartbeat_encode(1, 200, &msg, &heartbeat) == 21);
    CHECK(mavlink_msg_to_send_buffer(buffer, &msg) == 21 && buffer[0] == MAVLINK_STX && buffer[6] == 200);
    mavlink_msg_heartbeat_decode(&msg, &decoded);
    CHECK(decoded.type == MAV_TYPE_QUADROTOR && decoded.mavlink_version > 0);
    mavlink_msg_heartbeat_send_struct(MAVLINK_COMM_0, &heartbeat);
    CHECK(received.msgid == MAVLINK_MSG_ID_HEARTBEAT && mavlink_msg_heartbeat_get_type(&received) == 2);
}

static void test_attitude(void)
{
    mavlink_attitude_t attitude;
    mavlink_message_t msg;
    mavlink_msg_attitude_send(MAVLINK_COMM_0, 7, 1.0f, -2.0f, 3.0f, 4.0f, 5.0f, 0.0f);
    CHECK(received.len == 24); /* the zeros at the end are not sent */
    mavlink_msg_attitude_decode(&received, &attitude);
    CHECK(attitude.time_boot_ms == 7 && attitude.pitch >= -2.0f && attitude.pitch <= -2.0f);
    CHECK(mavlink_msg_attitude_get_time_boot_ms(&received) == 7);
    mavlink_msg_attitude_pack_chan(1, 1, MAVLINK_COMM_1, &msg, 7, 1.0f, -2.0f, 3.0f, 4.0f, 5.0f, 0.0f);
    CHECK(memcmp(_MAV_PAYLOAD(&msg), _MAV_PAYLOAD(&received), 28) == 0);
    CHECK(strcmp(mavlink_get_message_info(&msg)->fields[1].units, "rad") == 0);
}

/* A false start in front of a packet does not hide it, and the status tells of the error. */
static void test_false_start(void)
{
    static const uint8_t false_start[] = {0xFD, 0x00, 0x00, 0x01, 0xFE, 0x0A};
    uint8_t buffer[MAVLINK_MAX_PACKET_LEN];
    mavlink_status_t status;
    mavlink_message_t msg;
    size_t i, length;
    unsigned int found = 0, errors = 0;
    mavlink_msg_system_time_pack(1, 1, &msg, 1, 2);
    length = mavlink_msg_to_send_buffer(buffer, &msg);
    for (i = 0; i < sizeof(false_start); i++) {
        found += mavlink_parse_char(MAVLINK_COMM_3, false_start[i], &msg, &status);
        errors += status.packet_rx_drop_count;
    }
    for (i = 0; i < 3 * length; i++) {
        found += mavlink_parse_char(MAVLINK_COMM_3, buffer[i % length], &msg, &status);
        errors += status.packet_rx_drop_count;
    }
    CHECK(found == 3 && errors == 2 && status.packet_rx_success_count == 3);
    CHECK(mavlink_get_channel_status(MAVLINK_COMM_3)->packet_rx_success_count == 3);
}

static void test_signing(void)
{
    static mavlink_signing_streams_t streams;
    static mavlink_signing_t key;
    mavlink_status_t *sender = mavlink_get_channel_status(MAVLINK_COMM_0);
    mavlink_status_t *receiver = mavlink_get_channel_status(MAVLINK_COMM_1);
    const unsigned int before = count;
    mavlink_message_t msg;
    memset(key.secret_key, 42, sizeof(key.secret_key));
    key.flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
    key.timestamp = 1000;
    sender->signing = &key;
    receiver->signing = &key;
    receiver->signing_streams = &streams;
    mavlink_msg_system_time_send(MAVLINK_COMM_0, 1, 2);
    CHECK(count == before + 1 && key.last_status == MAVLINK_SIGNING_STATUS_OK && key.timestamp == 1001);
    CHECK(!mavlink_signature_check(&key, &streams, &received));
    CHECK(key.last_status == MAVLINK_SIGNING_STATUS_REPLAY);
    msg = received;
    _mavlink_resend_uart(MAVLINK_COMM_0, &msg);
    sender->signing = NULL;
    mavlink_msg_system_time_send(MAVLINK_COMM_0, 1, 2);
    CHECK(count == before + 1);
    receiver->signing = NULL;
}

int main(void)
{
    test_heartbeat();
    test_attitude();
    test_false_start();
    test_signing();
    count = 0;
    mavlink_test_all(1, 2, &received);
    mavlink_set_proto_version(MAVLINK_COMM_0, 1);
    mavlink_set_proto_version(MAVLINK_COMM_1, 1);
    mavlink_test_all(1, 2, &received);
    printf("%u packets\n", count);
    return 0;
}
