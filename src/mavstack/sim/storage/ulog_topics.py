"""Topics of a PX4 log: field names of PX4 1.16 and later, in the order of its structs."""

from __future__ import annotations

from mavstack.sim.storage.ulog_format import topics_of

_ATTITUDE = """
    uint64_t timestamp
    uint64_t timestamp_sample
    float q[4]
    float delta_q_reset[4] = 0
    uint8_t quat_reset_counter = 0
"""
_LOCAL_POSITION = """
    uint64_t timestamp
    uint64_t timestamp_sample
    uint64_t ref_timestamp
    double ref_lat
    double ref_lon
    float x
    float y
    float z
    float delta_xy[2] = 0
    float delta_z = 0
    float vx
    float vy
    float vz
    float z_deriv
    float delta_vxy[2] = 0
    float delta_vz = 0
    float ax
    float ay
    float az
    float heading
    float heading_var = 0.01
    float unaided_heading
    float delta_heading = 0
    float tilt_var = 0.001
    float ref_alt
    float dist_bottom
    float dist_bottom_var = 0
    float delta_dist_bottom = 0
    float eph
    float epv
    float evh = 0.2
    float evv = 0.2
    float vxy_max = inf
    float vz_max = inf
    float hagl_min = inf
    float hagl_max_z = inf
    float hagl_max_xy = inf
    bool xy_valid
    bool z_valid
    bool v_xy_valid
    bool v_z_valid
    uint8_t xy_reset_counter = 0
    uint8_t z_reset_counter = 0
    uint8_t vxy_reset_counter = 0
    uint8_t vz_reset_counter = 0
    uint8_t heading_reset_counter = 0
    bool heading_good_for_control = 1
    bool xy_global
    bool z_global
    bool dist_bottom_valid
    uint8_t dist_bottom_reset_counter = 0
    uint8_t dist_bottom_sensor_bitfield = 1
    bool dead_reckoning
"""
_SENSOR_COMBINED = """
    uint64_t timestamp
    float gyro_rad[3]
    uint32_t gyro_integral_dt = 5000
    int32_t accelerometer_timestamp_relative = 0
    float accelerometer_m_s2[3]
    uint32_t accelerometer_integral_dt = 5000
    uint8_t accelerometer_clipping = 0
    uint8_t gyro_clipping = 0
    uint8_t accel_calibration_count = 0
    uint8_t gyro_calibration_count = 0
"""
_ANGULAR_VELOCITY = """
    uint64_t timestamp
    uint64_t timestamp_sample
    float xyz[3]
    float xyz_derivative[3] = 0
"""
_GLOBAL_POSITION = """
    uint64_t timestamp
    uint64_t timestamp_sample
    double lat
    double lon
    float alt
    float alt_ellipsoid
    float delta_alt = 0
    float delta_terrain = 0
    float eph
    float epv
    float terrain_alt
    bool lat_lon_valid
    bool alt_valid
    uint8_t lat_lon_reset_counter = 0
    uint8_t alt_reset_counter = 0
    uint8_t terrain_reset_counter = 0
    bool terrain_alt_valid = 0
    bool dead_reckoning
"""
_GPS_POSITION = """
    uint64_t timestamp
    uint64_t timestamp_sample
    double latitude_deg
    double longitude_deg
    double altitude_msl_m
    double altitude_ellipsoid_m
    uint64_t time_utc_usec
    uint32_t device_id = 11469061
    float s_variance_m_s = 0.2
    float c_variance_rad = 0.1
    float eph
    float epv
    float hdop
    float vdop
    int32_t noise_per_ms = 80
    int32_t jamming_indicator = 10
    float vel_m_s
    float vel_n_m_s
    float vel_e_m_s
    float vel_d_m_s
    float cog_rad
    int32_t timestamp_time_relative = 0
    float heading = nan
    float heading_offset = nan
    float heading_accuracy = 0
    float rtcm_injection_rate = 0
    uint16_t automatic_gain_control = 0
    uint8_t fix_type
    uint8_t jamming_state = 1
    uint8_t spoofing_state = 1
    bool vel_ned_valid
    uint8_t satellites_used
    uint8_t selected_rtcm_instance = 0
    bool rtcm_crc_failed = 0
    uint8_t rtcm_msg_used = 0
"""
_AIR_DATA = """
    uint64_t timestamp
    uint64_t timestamp_sample
    uint32_t baro_device_id = 6620172
    float baro_alt_meter
    float baro_pressure_pa
    float ambient_temperature
    float rho
    uint8_t temperature_source = 0
    uint8_t calibration_count = 0
"""
_AIRSPEED = """
    uint64_t timestamp
    uint64_t timestamp_sample
    float indicated_airspeed_m_s
    float true_airspeed_m_s
    float confidence = 1
"""
_BATTERY = """
    uint64_t timestamp
    float voltage_v
    float current_a
    float current_average_a
    float discharged_mah
    float remaining
    float scale = 1
    float time_remaining_s = nan
    float temperature
    float voltage_cell_v[14] = 0
    float max_cell_voltage_delta = 0
    float full_charge_capacity_wh = nan
    float remaining_capacity_wh = nan
    float nominal_voltage = nan
    float internal_resistance_estimate = 0
    float ocv_estimate
    uint16_t capacity = 0
    uint16_t cycle_count = 0
    uint16_t average_time_to_empty = 0
    uint16_t state_of_health = 0
    uint16_t max_error = 0
    uint16_t interface_error = 0
    uint16_t faults = 0
    bool connected = 1
    uint8_t cell_count
    uint8_t source = 0
    uint8_t priority = 0
    uint8_t id = 1
    bool is_powering_off = 0
    bool is_required = 0
    uint8_t warning
"""
_INPUT_RC = """
    uint64_t timestamp
    uint64_t timestamp_last_signal
    int32_t rssi
    float rssi_dbm = nan
    uint16_t rc_lost_frame_count = 0
    uint16_t rc_total_frame_count = 0
    uint16_t rc_ppm_frame_length = 0
    uint16_t rc_frame_rate = 0
    uint16_t values[18]
    uint8_t channel_count
    bool rc_failsafe = 0
    bool rc_lost
    uint8_t input_source = 6
    int8_t link_quality = -1
    int8_t link_snr = 0
"""
_OUTPUTS = """
    uint64_t timestamp
    uint32_t noutputs = 16
    float output[16]
"""
_STATUS = """
    uint64_t timestamp
    uint64_t armed_time
    uint64_t takeoff_time
    uint64_t nav_state_timestamp
    uint32_t valid_nav_states_mask = 2147411071
    uint32_t can_set_nav_states_mask = 8307839
    uint8_t arming_state
    uint8_t latest_arming_reason
    uint8_t latest_disarming_reason
    uint8_t nav_state_user_intention
    uint8_t nav_state
    uint8_t executor_in_charge = 0
    uint8_t hil_state = 0
    uint8_t vehicle_type
    bool failsafe
    bool failsafe_and_user_took_over = 0
    uint8_t failsafe_defer_state = 0
    bool gcs_connection_lost = 0
    uint8_t gcs_connection_lost_counter = 0
    bool high_latency_data_link_lost = 0
    bool is_vtol
    bool is_vtol_tailsitter = 0
    bool in_transition_mode = 0
    bool in_transition_to_fw = 0
    uint8_t system_type
    uint8_t system_id
    uint8_t component_id = 1
    bool safety_button_available = 0
    bool safety_off = 1
    bool power_input_valid = 1
    bool usb_connected = 0
    bool open_drone_id_system_present = 0
    bool open_drone_id_system_healthy = 0
    bool parachute_system_present = 0
    bool parachute_system_healthy = 0
    bool rc_calibration_in_progress = 0
    bool calibration_enabled = 0
    bool pre_flight_checks_pass = 1
"""
_LAND_DETECTED = """
    uint64_t timestamp
    bool freefall = 0
    bool ground_contact
    bool maybe_landed
    bool landed
    bool in_ground_effect = 0
    bool in_descend = 0
    bool has_low_throttle
    bool vertical_movement
    bool horizontal_movement
    bool rotational_movement = 0
    bool close_to_ground_or_skipped_check = 0
    bool at_rest
"""
_MISSION_RESULT = """
    uint64_t timestamp
    uint32_t mission_id = 0
    uint32_t geofence_id = 0
    uint32_t home_position_counter = 0
    int32_t seq_reached
    uint16_t seq_current
    uint16_t seq_total
    uint16_t item_changed_index = 0
    uint16_t item_do_jump_remaining = 0
    bool valid
    bool warning = 0
    bool finished
    bool failure = 0
    bool item_do_jump_changed = 0
    uint8_t execution_mode = 0
"""
_HOME = """
    uint64_t timestamp
    double lat
    double lon
    float alt
    float x = 0
    float y = 0
    float z = 0
    float roll = 0
    float pitch = 0
    float yaw = 0
    uint32_t update_count = 1
    bool valid_alt = 1
    bool valid_hpos = 1
    bool valid_lpos = 1
    bool valid_attitude = 1
    bool manual_home = 0
"""
_EVENT = """
    uint64_t timestamp
    uint32_t id
    uint16_t event_sequence
    uint8_t arguments[25] = 0
    uint8_t log_levels
"""

TOPICS = topics_of(
    {
        "vehicle_attitude": _ATTITUDE,
        "vehicle_local_position": _LOCAL_POSITION,
        "sensor_combined": _SENSOR_COMBINED,
        "vehicle_angular_velocity": _ANGULAR_VELOCITY,
        "vehicle_global_position": _GLOBAL_POSITION,
        "vehicle_gps_position": _GPS_POSITION,
        "vehicle_air_data": _AIR_DATA,
        "airspeed": _AIRSPEED,
        "battery_status": _BATTERY,
        "input_rc": _INPUT_RC,
        "actuator_outputs": _OUTPUTS,
        "vehicle_status": _STATUS,
        "vehicle_land_detected": _LAND_DETECTED,
        "mission_result": _MISSION_RESULT,
        "home_position": _HOME,
        "event": _EVENT,
    }
)
