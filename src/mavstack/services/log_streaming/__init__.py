"""Log streaming: an onboard log (ULog) over MAVLink while it is written (PX4's manual: ULog streaming).

    MAV_CMD_LOGGING_START ──► header and definitions in LOGGING_DATA_ACKED, each acknowledged by LOGGING_ACK,
                              then the records in LOGGING_DATA, which are not acknowledged
    MAV_CMD_LOGGING_STOP  ──► the end

All blocks share one sequence of 16 bits, so that a receiver notices missing ones. A block says where its
first message starts, so that the receiver continues behind a gap, whose length it writes into the log.
"""

from mavstack.services.log_streaming.assembler import LogAssembler
from mavstack.services.log_streaming.framing import BLOCK_SIZE, HEADER_SIZE, MAGIC
from mavstack.services.log_streaming.receiver import LogStreamData, LogStreamGap, LogStreamReceiver
from mavstack.services.log_streaming.sender import LogStreamSender, LogStreamStarted, LogStreamStopped

__all__ = [
    "BLOCK_SIZE",
    "HEADER_SIZE",
    "MAGIC",
    "LogAssembler",
    "LogStreamData",
    "LogStreamGap",
    "LogStreamReceiver",
    "LogStreamSender",
    "LogStreamStarted",
    "LogStreamStopped",
]
