/* A small firmware: receives ATTITUDE and SYSTEM_TIME, sends HEARTBEAT. */
#include "common/mavlink.h"

int uart_read(void);
void uart_write(const uint8_t *bytes, uint16_t length);
extern float roll;
extern uint32_t boot_time;

void step(void);
void step(void)
{
    static mavlink_message_t msg;
    mavlink_status_t status;
    uint8_t buffer[MAVLINK_MAX_PACKET_LEN];
    int byte;
    while ((byte = uart_read()) >= 0) {
        if (mavlink_parse_char(MAVLINK_COMM_0, (uint8_t)byte, &msg, &status)) {
            if (msg.msgid == MAVLINK_MSG_ID_ATTITUDE) {
                mavlink_attitude_t attitude;
                mavlink_msg_attitude_decode(&msg, &attitude);
                roll = attitude.roll;
            } else if (msg.msgid == MAVLINK_MSG_ID_SYSTEM_TIME) {
                boot_time = mavlink_msg_system_time_get_time_boot_ms(&msg);
            }
        }
    }
    mavlink_msg_heartbeat_pack(1, 1, &msg, MAV_TYPE_QUADROTOR, MAV_AUTOPILOT_GENERIC, 0, 0, MAV_STATE_ACTIVE);
    uart_write(buffer, mavlink_msg_to_send_buffer(buffer, &msg));
}
