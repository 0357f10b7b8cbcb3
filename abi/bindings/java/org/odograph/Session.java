// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.lang.ref.Reference;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.util.function.Consumer;

/** A session: one pipeline, from samples to poses. Threads as in odograph.h. */
public final class Session implements java.io.Closeable {
    private long session, listener;
    private Consumer<Event> consumer;
    private volatile Throwable thrown;
    private volatile Thread calling; // in the consumer

    /** `config`: a YAML file, or its text. A text has a line break or ": " in it, as every YAML mapping has; a path with either is taken for one. */
    public Session(String config) { this(config, false, ""); }

    /** `live`: processes samples on a thread of the session, otherwise within push. */
    public Session(String config, boolean live, String pluginPath) {
        Abi.SessionOptions options = new Abi.SessionOptions().run(live ? Abi.ODO_RUN_LIVE : Abi.ODO_RUN_REPLAY);
        ByteBuffer yaml = Struct.utf8(config), plugins = Struct.utf8(pluginPath), made = pointer();
        if (config.indexOf('\n') >= 0 || config.contains(": ")) options.config_text_data(Native.address(yaml)).config_text_size(yaml.capacity() - 1);
        else options.config_path_data(Native.address(yaml)).config_path_size(yaml.capacity() - 1);
        options.plugin_path_data(Native.address(plugins)).plugin_path_size(plugins.capacity() - 1);
        OdographException.Text error = new OdographException.Text();
        OdographException.check(Abi.odo_session_create(options.address, Native.address(made), error.address), error);
        stays(options, yaml, plugins);
        session = made.getLong(0);
    }

    /** Keeps an object reachable until this call, because native code uses its address. */
    static void stays(Object... objects) { Reference.reachabilityFence(objects); }

    static ByteBuffer pointer() { return ByteBuffer.allocateDirect(8).order(ByteOrder.LITTLE_ENDIAN); }

    private long open() {
        if (session == 0) throw new IllegalStateException("the session was closed");
        return session;
    }

    /** Calls `consumer` with each event of these types (ODO_TYPE_*), or with all events if none is given: within push and flush, or on
     * the library's thread when live. The next push or flush rethrows what it throws; events go on. */
    public void onEvent(Consumer<Event> consumer, int... types) {
        long before = listener;
        this.consumer = consumer;
        listener = Native.listen(open(), types, this);
        Native.unlisten(before);
    }

    private void take(long event) { // called by odograph_jni.c
        Thread before = calling;
        calling = Thread.currentThread();
        try {
            consumer.accept(new Event(event));
        } catch (Throwable e) { // must not propagate through the library
            thrown = e;
        } finally {
            calling = before;
        }
    }

    private int checked(int status) {
        Throwable e = thrown;
        thrown = null;
        if (e != null) Session.<RuntimeException>rethrow(e);
        return status;
    }

    @SuppressWarnings("unchecked") // whatever the consumer has thrown, checked or not
    private static <T extends Throwable> void rethrow(Throwable e) throws T { throw (T) e; }

    /** Pushes any input except a frame. Returns ODO_OK, or the status of a rejected message. */
    public int push(Struct message) {
        try {
            return checked(Abi.odo_session_push(open(), message.address));
        } finally {
            Reference.reachabilityFence(message);
        }
    }
    public int push(Event message) { return checked(Abi.odo_session_push(open(), message.address)); }

    /** Pushes a frame whose pixels start at byte `begin` of a direct buffer, which the library shares without copying. Set format,
     * width and height in the frame; rows are `rowStride` bytes apart, at least a row's own bytes. */
    public int pushFrame(Abi.Frame frame, ByteBuffer pixels, int begin, int rowStride) {
        int format = frame.format(), pixel = format == Abi.ODO_FORMAT_RGB8 ? 3 : format == Abi.ODO_FORMAT_RGBA8 || format == Abi.ODO_FORMAT_BGRA8 ? 4 : 1;
        if (begin < 0 || rowStride < (long) frame.width() * pixel) throw new IllegalArgumentException("begin " + begin + ", rowStride " + rowStride + ": expected 0 or more, and at least " + (long) frame.width() * pixel);
        long end = begin + (frame.height() - 1L) * rowStride + (long) frame.width() * pixel;
        if (!pixels.isDirect() || end > pixels.capacity()) throw new IllegalArgumentException("pixels: expected a direct buffer of at least " + end + " bytes");
        frame.plane_count(1).planes0_row_stride(rowStride).planes0_pixel_stride(pixel);
        try {
            return checked(Native.pushFrame(open(), frame.address, pixels, begin));
        } finally {
            Reference.reachabilityFence(frame);
        }
    }

    /** Number of pictures that the library still borrows, in all sessions. */
    public static int borrowed() { return Native.borrowed(); }

    /** Processes all pushed samples without waiting for slower sensors. */
    public void flush() { OdographException.check(checked(Abi.odo_session_flush(open()))); }

    /** The pose at the newest sample, or null. */
    public Abi.Pose pose() { return pose(Abi.ODO_TIME_LATEST, false); }
    /** The pose at a time, which may be in the near future; null if not available. `smooth`: without jumps, for rendering. */
    public Abi.Pose pose(long t_ns, boolean smooth) {
        Abi.Pose pose = new Abi.Pose(0);
        int world = smooth ? Abi.ODO_WORLD_SMOOTH : Abi.ODO_WORLD_CORRECTED;
        int status = Abi.odo_session_get_pose_of(open(), Abi.ODO_OF_PIPELINE, world, t_ns, pose.address);
        return status == Abi.ODO_OK ? pose : null;
    }

    public Abi.Statistics statistics() {
        Abi.Statistics made = new Abi.Statistics();
        OdographException.check(Abi.odo_session_get_statistics(open(), made.address));
        return made;
    }

    /** The latest error or warning since the last call, or null. */
    public String lastError() {
        OdographException.Text error = new OdographException.Text();
        OdographException.check(Abi.odo_session_last_error(open(), error.address));
        return error.status() == Abi.ODO_OK ? null : error.message();
    }

    /** Creates an anchor and returns its id. */
    public long createAnchor(Abi.AnchorPlace place, String name) {
        ByteBuffer text = Struct.utf8(name), id = pointer();
        place.name_data(Native.address(text)).name_size(text.capacity() - 1);
        OdographException.check(Abi.odo_anchor_create(open(), place.address, Native.address(id)));
        stays(place, text);
        return id.getLong(0);
    }
    public Abi.Anchor anchor(long id, int world, long t_ns) {
        Abi.Anchor anchor = new Abi.Anchor();
        OdographException.check(Abi.odo_anchor_get(open(), id, world, t_ns, anchor.address));
        return anchor;
    }
    /** The nearest thing that a ray hits; null if there is none, or while position or scale are unknown. Set kind, and pixel or origin and
     * direction. To place something there, pass placeOf(hit) to createAnchor. */
    public Abi.Hit hitTest(Abi.Ray ray) {
        Abi.Hit hit = new Abi.Hit();
        ByteBuffer count = pointer();
        OdographException.check(Abi.odo_session_hit_test(open(), ray.address, hit.address, 1, Native.address(count)));
        stays(ray, hit);
        return count.getInt(0) > 0 ? hit : null;
    }
    public static Abi.AnchorPlace placeOf(Abi.Hit hit, int world) {
        return new Abi.AnchorPlace().kind(Abi.ODO_ANCHOR_HIT).t_ns(hit.t_ns()).world(world).q(hit.q_n()).p(hit.p_n()).surface(hit.surface()).sigma_m(hit.sigma_m());
    }
    public void removeAnchor(long id) { OdographException.check(Abi.odo_anchor_remove(open(), id)); }

    /** Maps of the places that this session has seen, with its anchors, for loadMap in a later one; empty if there are none. */
    public byte[] saveMap() {
        for (int capacity = 0;;) {
            ByteBuffer data = ByteBuffer.allocateDirect(capacity);
            long size = Abi.odo_map_save(open(), Native.address(data), capacity);
            OdographException.check((int) Math.min(size, 0));
            if (size == capacity) {
                byte[] map = new byte[capacity];
                data.get(map);
                return map;
            }
            capacity = Math.toIntExact(size);
        }
    }
    /** Throws if the map is damaged, or of plugins that the session does not have. */
    public void loadMap(byte[] data) {
        ByteBuffer copy = ByteBuffer.allocateDirect(data.length).put(data);
        OdographException.check(Abi.odo_map_load(open(), Native.address(copy), data.length));
        stays(copy);
    }

    /** Not within the consumer of onEvent, where it throws an IllegalStateException. */
    @Override
    public void close() {
        if (calling == Thread.currentThread()) throw new IllegalStateException("close() within onEvent's consumer: close the session after push or flush has returned");
        Abi.odo_session_destroy(session);
        Native.unlisten(listener);
        session = listener = 0;
    }
}
