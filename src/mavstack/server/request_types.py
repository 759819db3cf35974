"""Types and models of fields that several requests have."""

from __future__ import annotations

from typing import Annotated, Any, Final, TypeAlias

from msgspec import Meta

from mavstack.http.request_fields import Fields

#: Maximum length of a text in a request in characters, unless its field allows more.
MAX_TEXT: Final = 4096

Text: TypeAlias = Annotated[str, Meta(max_length=MAX_TEXT)]
Positive: TypeAlias = Annotated[float, Meta(ge=0)]
Degrees90: TypeAlias = Annotated[float, Meta(ge=-90, le=90)]
Degrees180: TypeAlias = Annotated[float, Meta(ge=-180, le=180)]
Latitude: TypeAlias = Annotated[Degrees90, Meta(description="Degrees.", examples=[47.398])]
Longitude: TypeAlias = Annotated[Degrees180, Meta(description="Degrees.", examples=[8.546])]
Timeout: TypeAlias = Annotated[
    Positive | None, Meta(description="Seconds for the whole call; null: no limit.")
]


class SendMessage(Fields):
    """Send a message; its target is in its fields."""

    message: Annotated[Text, Meta(description="The name of the message.", examples=["PING"])]
    fields: Annotated[
        dict[str, Any],
        Meta(description="The fields by name; missing ones are 0, null is NaN.", examples=[{"seq": 1}]),
    ] = {}  # noqa: RUF012 (msgspec makes a new one for each request)
