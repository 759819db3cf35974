-- Shows the results of the generated module for the conformance corpus; see conformance/README.md.
-- The first argument is the folder of the module, the second the length of the chunks.

package.path = arg[1] .. "/?.lua;" .. package.path
local mavlink = require("mavlink")
local chunk_length = tonumber(arg[2])

local FORMATS = {
    char = "B", uint8_t = "B", int8_t = "b", uint16_t = "<I2", int16_t = "<i2", uint32_t = "<I4", int32_t = "<i4",
    uint64_t = "<I8", int64_t = "<i8", float = "<f", double = "<d",
}

local pack = string.pack
if not pack then
    local ffi = require("ffi")
    local arrays = {}
    for name in pairs(FORMATS) do
        arrays[name] = ffi.new(name .. "[1]")
    end
    pack = function(format, value)
        for name, other in pairs(FORMATS) do
            if other == format then
                arrays[name][0] = value
                return ffi.string(arrays[name], ffi.sizeof(arrays[name]))
            end
        end
    end
end

local function hex(text)
    return (text:gsub(".", function(character)
        return ("%02x"):format(character:byte())
    end))
end

local function unhex(text)
    return (text:gsub("..", function(digits)
        return string.char(tonumber(digits, 16))
    end))
end

local function value_bytes(field, value)
    if type(value) == "string" then
        return value .. ("\0"):rep(field.array_length - #value)
    elseif field.array_length == 0 then
        return pack(FORMATS[field.type], value)
    end
    local parts = {}
    for index = 1, field.array_length do
        parts[index] = pack(FORMATS[field.type], value[index])
    end
    return table.concat(parts)
end

local function show(packet, key)
    local message = packet:decode()
    local words = {
        "packet", packet.name, packet.id, packet.version, packet.sequence, packet.system, packet.component,
        packet.signed and 1 or 0,
    }
    for _, field in ipairs(mavlink.definition(packet.id).fields) do
        words[#words + 1] = field.name .. "=" .. hex(value_bytes(field, message[field.key]))
    end
    print(table.concat(words, " "))
    local encoder = mavlink.Encoder.new(packet) -- version, sequence, system and component
    if packet.signed and key then
        encoder.signer = mavlink.Signer.new(key, packet.link_id, packet.timestamp - 1)
    end
    print("packed " .. packet.name .. " " .. hex(encoder:encode(packet.name, message)))
end

for line in io.lines() do
    local name, key, now, input = line:match("^(%S+) (%S+) (%S+) ?(%x*)$")
    key = key ~= "-" and unhex(key) or nil
    now = tonumber(now)
    local parser = mavlink.Parser.new()
    local verifier = key and mavlink.Verifier.new(key)
    local good = 0
    local bytes = unhex(input)
    for position = 1, #bytes, chunk_length do
        for _, packet in ipairs(parser:push(bytes:sub(position, position + chunk_length - 1))) do
            if not (verifier and not verifier:verify(packet, now)) and packet.name then
                good = good + 1
                show(packet, key)
            end
        end
    end
    print(("end %s good=%d bad_crc=%d bad_signature=%d unknown=%d"):format(
        name, good, parser.statistics.bad_checksum, verifier and verifier.refused or 0, parser.statistics.unknown
    ))
end
