// Not compiled yet, because no Swift compiler was available. clang compiles the imported module map; nothing else is tested.
// SPDX-License-Identifier: Apache-2.0
@_exported import COdograph

/// An error of the library: `status` is ODO_E_*, the message states the reason.
public struct OdographError: Error, CustomStringConvertible {
    public let status: Int32
    public let description: String

    static func check(_ status: Int32, _ error: odo_error? = nil) throws {
        guard status < 0 else { return }
        var text = String(cString: odo_status_text(status))
        if var error = error {
            let message = withUnsafeBytes(of: &error.message) { String(cString: $0.bindMemory(to: CChar.self).baseAddress!) }
            if !message.isEmpty { text = message }
        }
        throw OdographError(status: status, description: text)
    }
}

/// A message: a struct that starts with an odo_header, and its type number.
public protocol Message {
    static var type: UInt32 { get }
    init()
    var header: odo_header { get set }
}
extension Message {
    /// A zeroed message with size, type and time set.
    public init(at t_ns: Int64) {
        self.init()
        header.struct_size = UInt32(MemoryLayout<Self>.size)
        header.type = Self.type
        header.t_ns = t_ns
    }
}

/// A borrowed message of any type: an event is valid during its call, a recorded message until the next one.
public struct Event {
    public let header: UnsafePointer<odo_header>
    public var isInput: Bool { header.pointee.type >> 12 != 1 }

    /// The landmarks of an odo_points; none of another type.
    public func points() -> [odo_point] {
        guard let message = get(odo_points.self) else { return [] }
        return elements(message.count, message.stride, message.offset)
    }
    /// The outline of an odo_surface; none of another type.
    public func outline() -> [odo_vertex] {
        guard let message = get(odo_surface.self) else { return [] }
        return elements(message.count, message.stride, message.offset)
    }
    private func elements<E>(_ count: UInt32, _ stride: UInt32, _ offset: UInt32) -> [E] {
        if stride < UInt32(MemoryLayout<E>.size) { return [] }
        let base = UnsafeRawPointer(header), end = Int(header.pointee.struct_size)
        return (0..<Int(count)).map { Int(offset) + $0 * Int(stride) }
            .prefix { $0 + Int(stride) <= end }
            .map { base.loadUnaligned(fromByteOffset: $0, as: E.self) }
    }

    /// Returns a copy of the message if it has that type. Landmarks are not copied: see points().
    public func get<M: Message>(_: M.Type) -> M? {
        guard header.pointee.type == M.type else { return nil }
        var message = M()
        let size = min(MemoryLayout<M>.size, Int(header.pointee.struct_size))
        withUnsafeMutableBytes(of: &message) { $0.copyMemory(from: UnsafeRawBufferPointer(start: header, count: size)) }
        message.header.struct_size = UInt32(size)
        return message
    }
}

private func withString<R>(_ text: String, _ body: (odo_string) throws -> R) rethrows -> R {
    var text = text
    return try text.withUTF8 { bytes in
        try bytes.withMemoryRebound(to: CChar.self) { try body(odo_string(data: $0.baseAddress, size: UInt64($0.count))) }
    }
}

/// A session: one pipeline. Threads as in odograph.h.
public final class Session: @unchecked Sendable {
    private final class Listener {
        let call: (Event) -> Void
        init(_ call: @escaping (Event) -> Void) { self.call = call }
    }
    private let session: OpaquePointer
    private var listener: Listener?

    /// `config`: a YAML file, or its text. A text has a line break or ": " in it, as every YAML mapping has; a path with either is taken for one.
    public init(config: String, live: Bool = false) throws {
        var made: OpaquePointer?
        var error = odo_error()
        error.struct_size = UInt32(MemoryLayout<odo_error>.size)
        var options = odo_session_options()
        options.struct_size = UInt32(MemoryLayout<odo_session_options>.size)
        options.run = live ? ODO_RUN_LIVE : ODO_RUN_REPLAY
        try withString(config) { text in
            if config.contains("\n") || config.contains(": ") { options.config_text = text } else { options.config_path = text }
            let status = odo_session_create(&options, &made, &error)
            try OdographError.check(status, error)
        }
        session = made!
    }
    deinit { odo_session_destroy(session) }

    /// Calls `listener` with each event of these types: within push and flush, or on the library's thread when live.
    public func onEvent(_ types: [UInt32], _ call: @escaping (Event) -> Void) throws {
        let made = Listener(call)
        let status = odo_session_set_callback(session, types, UInt32(types.count), { user, event in
            Unmanaged<Listener>.fromOpaque(user!).takeUnretainedValue().call(Event(header: event!))
        }, Unmanaged.passUnretained(made).toOpaque())
        try OdographError.check(status)
        listener = made
    }

    /// Returns ODO_OK, or the status of a rejected message.
    @discardableResult public func push<M: Message>(_ message: M) -> Int32 {
        withUnsafeBytes(of: message) { odo_session_push(session, $0.bindMemory(to: odo_header.self).baseAddress) }
    }
    @discardableResult public func push(_ message: Event) -> Int32 { odo_session_push(session, message.header) }

    /// Pushes a frame whose pixels `owner` keeps alive (a CVPixelBuffer, an object of the app). The library retains it and does not copy.
    @discardableResult public func push(_ frame: odo_frame, owner: AnyObject) -> Int32 {
        var lent = frame
        let shared = Unmanaged.passRetained(owner)
        defer { shared.release() }
        lent.loan.owner = shared.toOpaque()
        lent.loan.retain = { Unmanaged<AnyObject>.fromOpaque($0!).retain(); return ODO_OK }
        lent.loan.release = { Unmanaged<AnyObject>.fromOpaque($0!).release() }
        return push(lent)
    }

    public func flush() throws { try OdographError.check(odo_session_flush(session)) }

    /// The pose at a time; nil if not available. `smooth`: without jumps, for rendering.
    public func pose(at t_ns: Int64 = Int64.min, smooth: Bool = false) -> odo_pose? {
        var pose = odo_pose(at: 0)
        let world = smooth ? ODO_WORLD_SMOOTH : ODO_WORLD_CORRECTED
        return odo_session_get_pose_of(session, ODO_OF_PIPELINE, world, t_ns, &pose) == ODO_OK ? pose : nil
    }

    public func createAnchor(_ place: odo_anchor_place, name: String) throws -> UInt64 {
        var id: UInt64 = 0
        var place = place
        place.struct_size = UInt32(MemoryLayout<odo_anchor_place>.size)
        try withString(name) { text in
            place.name = text
            try OdographError.check(odo_anchor_create(session, &place, &id))
        }
        return id
    }
    /// The nearest thing that a ray hits; nil if there is none, or while position or scale are unknown.
    public func hitTest(_ ray: odo_ray) throws -> odo_hit? {
        var ray = ray, hit = odo_hit(), count: UInt32 = 0
        ray.struct_size = UInt32(MemoryLayout<odo_ray>.size)
        hit.struct_size = UInt32(MemoryLayout<odo_hit>.size)
        try OdographError.check(odo_session_hit_test(session, &ray, &hit, 1, &count))
        return count > 0 ? hit : nil
    }
    public func anchor(_ id: UInt64, world: UInt32 = ODO_WORLD_CORRECTED, at t_ns: Int64 = Int64.min) throws -> odo_anchor {
        var anchor = odo_anchor()
        anchor.struct_size = UInt32(MemoryLayout<odo_anchor>.size)
        try OdographError.check(odo_anchor_get(session, id, world, t_ns, &anchor))
        return anchor
    }

    /// Maps of the places that this session has seen, with its anchors, for loadMap in a later one; empty if there are none.
    public func saveMap() throws -> [UInt8] {
        var data: [UInt8] = []
        while true {
            let size = odo_map_save(session, &data, UInt64(data.count))
            if size == Int64(data.count) { return data }
            try OdographError.check(Int32(min(size, 0)))
            data = [UInt8](repeating: 0, count: Int(size))
        }
    }
    /// Throws if the map is damaged, or of plugins that the session does not have.
    public func loadMap(_ data: [UInt8]) throws { try OdographError.check(odo_map_load(session, data, UInt64(data.count))) }
}

/// A recording, which is read once: `while let (message, picture) = recording.next()`. Both are valid until the next call.
public final class Recording {
    private let recording: OpaquePointer

    public init(_ path: String) throws {
        var made: OpaquePointer?
        var error = odo_error()
        error.struct_size = UInt32(MemoryLayout<odo_error>.size)
        try withString(path) { text in
            var name = text
            let status = odo_recording_open(&name, &made, &error)
            try OdographError.check(status, error)
        }
        recording = made!
    }
    deinit { odo_recording_close(recording) }

    /// The next message; nil at the end. Records that cannot be read are skipped and counted in `loss`.
    public func next() -> (message: Event, picture: UnsafeRawBufferPointer?)? {
        var message: UnsafePointer<odo_header>?
        var picture: UnsafeRawPointer?
        var size: UInt64 = 0
        var status: Int32
        repeat { status = odo_recording_next(recording, &message, &picture, &size) } while status == ODO_E_DATA
        guard status == ODO_OK else { return nil }
        return (Event(header: message!), picture.map { UnsafeRawBufferPointer(start: $0, count: Int(size)) })
    }

    /// Describes missing data; empty if the recording is complete.
    public var loss: String {
        var loss = odo_error()
        loss.struct_size = UInt32(MemoryLayout<odo_error>.size)
        guard odo_recording_loss(recording, &loss) == ODO_OK else { return "" }
        return withUnsafeBytes(of: &loss.message) { String(cString: $0.bindMemory(to: CChar.self).baseAddress!) }
    }
}
