"""The camera definition file of simulated cameras."""

from __future__ import annotations

from functools import cache

from mavstack.services.camera import CameraDefinition, read_definition

VERSION = 1
TEXT = """<?xml version="1.0" encoding="UTF-8" ?>
<mavlinkcamera>
  <definition version="1">
    <model>Simulated camera</model>
    <vendor>Mavstack</vendor>
  </definition>
  <parameters>
    <parameter name="CAM_MODE" type="uint32" default="0" control="0">
      <description>Camera mode</description>
      <updates><update>CAM_ISO</update></updates>
      <options>
        <option name="Photo" value="0">
          <exclusions><exclude>CAM_VIDRES</exclude></exclusions>
        </option>
        <option name="Video" value="1">
          <exclusions><exclude>CAM_PHOTOFMT</exclude></exclusions>
          <parameterranges>
            <parameterrange parameter="CAM_ISO" condition="CAM_EXPMODE=1">
              <roption name="100" value="100" />
              <roption name="200" value="200" />
              <roption name="400" value="400" />
            </parameterrange>
          </parameterranges>
        </option>
      </options>
    </parameter>
    <parameter name="CAM_EXPMODE" type="uint32" default="0">
      <description>Exposure mode</description>
      <updates><update>CAM_ISO</update></updates>
      <options>
        <option name="Auto" value="0">
          <exclusions><exclude>CAM_ISO</exclude></exclusions>
        </option>
        <option name="Manual" value="1">
          <exclusions><exclude>CAM_EV</exclude></exclusions>
        </option>
      </options>
    </parameter>
    <parameter name="CAM_ISO" type="uint32" default="100">
      <description>Sensitivity</description>
      <options>
        <option name="100" value="100" />
        <option name="200" value="200" />
        <option name="400" value="400" />
        <option name="800" value="800" />
        <option name="1600" value="1600" />
      </options>
    </parameter>
    <parameter name="CAM_EV" type="float" default="0" min="-3" max="3" step="0.5" unit="EV">
      <description>Exposure compensation</description>
    </parameter>
    <parameter name="CAM_WBMODE" type="uint32" default="0">
      <description>White balance</description>
      <options>
        <option name="Auto" value="0" />
        <option name="Sunny" value="1" />
        <option name="Cloudy" value="2" />
        <option name="Sunset" value="3" />
      </options>
    </parameter>
    <parameter name="CAM_VIDRES" type="uint32" default="1">
      <description>Video resolution</description>
      <options>
        <option name="3840 x 2160" value="0" />
        <option name="1920 x 1080" value="1" />
      </options>
    </parameter>
    <parameter name="CAM_PHOTOFMT" type="uint32" default="0">
      <description>Image format</description>
      <options>
        <option name="JPEG" value="0" />
        <option name="Raw" value="1" />
      </options>
    </parameter>
    <parameter name="CAM_IRLOCK" type="bool" default="0">
      <description>Infrared beacon</description>
    </parameter>
  </parameters>
</mavlinkcamera>
"""


@cache
def simulated_definition() -> CameraDefinition:
    """Return the settings of simulated cameras."""
    return read_definition(TEXT.encode())
