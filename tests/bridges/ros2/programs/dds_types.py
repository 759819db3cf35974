"""Types of ROS 2 as Cyclone DDS describes them, and endpoints that use them."""

from dataclasses import dataclass
from typing import Any

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic


@dataclass
class Float64(IdlStruct, typename="std_msgs.msg.dds_.Float64_"):
    data: float64


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs.msg.dds_.Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Twist(IdlStruct, typename="geometry_msgs.msg.dds_.Twist_"):
    linear: Vector3
    angular: Vector3


def participant(domain: int) -> Any:
    return DomainParticipant(domain)


def reader(owner: Any, name: str, kind: Any) -> Any:
    return DataReader(owner, Topic(owner, name, kind))


def writer(owner: Any, name: str, kind: Any) -> Any:
    return DataWriter(owner, Topic(owner, name, kind))
