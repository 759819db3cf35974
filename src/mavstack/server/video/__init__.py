"""Video of cameras in the browser: the station receives RTSP and RTP, and sends WebRTC.

    addresses    which addresses are opened, and the session description of RTP
    sources      open cameras, which all viewers share
    gateway      the viewers: WebRTC by one HTTP request (WHEP)
    recordings   the recorded files; recorder, video_file: a recording, and one of its files

Only `addresses` and `recordings` work without the extra `video`.
"""

from __future__ import annotations
