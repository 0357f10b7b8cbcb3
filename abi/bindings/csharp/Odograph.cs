// SPDX-License-Identifier: Apache-2.0
// Odograph for C# (Unity with Mono or IL2CPP, and .NET). Samples, frames, events and poses cause no allocation. The structs
// in Abi.cs have the fields of the C headers, which state units, frames of reference and validity. Compile with -unsafe.
using System;
using System.Runtime.InteropServices;
using System.Text;
using System.Threading;

namespace Odograph {
  /// IL2CPP requires an attribute of this name on methods that native code calls.
  [AttributeUsage(AttributeTargets.Method)]
  sealed class MonoPInvokeCallbackAttribute : Attribute {
    public MonoPInvokeCallbackAttribute(Type type) {}
  }

  /// Three numbers: m, m/s, rad/s ...
  public struct Vector {
    public double x, y, z;
    public Vector(double x, double y, double z) { this.x = x; this.y = y; this.z = z; }
  }

  /// A Hamilton quaternion.
  public struct Rotation {
    public double w, x, y, z;
    public Rotation(double w, double x, double y, double z) { this.w = w; this.x = x; this.y = y; this.z = z; }
  }

  /// An error of the library: Status is ODO_E_*, the message states the reason.
  public sealed unsafe class OdographException : Exception {
    public readonly int Status;
    OdographException(int status, string text) : base(text) { Status = status; }

    internal static void Check(int status, odo_error* error = null) {
      if (status >= 0) return;
      string text = error == null ? "" : Marshal.PtrToStringAnsi((IntPtr)error->message);
      throw new OdographException(status, text != "" ? text : Marshal.PtrToStringAnsi((IntPtr)Abi.odo_status_text(status)));
    }

    /// The loader finds the library by a name without a major version: it may be another one than that of these declarations.
    internal static void CheckAbi() {
      uint abi = Abi.odo_abi_version();
      if (abi >> 16 != Abi.ODO_ABI_MAJOR)
        throw new OdographException(Abi.ODO_E_VERSION, "the library has ABI " + (abi >> 16) + "." + (abi & 0xFFFF) + ", this package " + Abi.ODO_ABI_MAJOR + "." + Abi.ODO_ABI_MINOR);
    }
  }

  /// A borrowed message of any type: an event is valid during its call, a recorded message until the next one. TryGet copies it.
  public unsafe partial struct Event {
    public readonly odo_header* Header;
    public Event(odo_header* header) { Header = header; }
    public uint Type => Header->type;
    public long T_ns => Header->t_ns;
    public bool IsInput => Type >> 12 != 1;

    /// Landmark i of an odo_points, valid as long as the event; null beyond the last one, and of another type.
    public Point* Landmark(uint i) {
      if (Header->type != Abi.ODO_TYPE_POINTS || Header->struct_size < sizeof(Points)) return null;
      var message = (Points*)Header;
      ulong begin = message->offset + (ulong)i * message->stride;
      return i < message->count && message->stride >= sizeof(Point) && begin + message->stride <= Header->struct_size ? (Point*)((byte*)Header + begin) : null;
    }

    /// Vertex i of an odo_surface, likewise.
    public Vertex* OutlineVertex(uint i) {
      if (Header->type != Abi.ODO_TYPE_SURFACE || Header->struct_size < sizeof(Surface)) return null;
      var message = (Surface*)Header;
      ulong begin = message->offset + (ulong)i * message->stride;
      return i < message->count && message->stride >= sizeof(Vertex) && begin + message->stride <= Header->struct_size ? (Vertex*)((byte*)Header + begin) : null;
    }

    bool Copy(void* to, uint type, uint size) {
      if (Header->type != type) return false;
      uint available = Math.Min(size, Header->struct_size);
      Buffer.MemoryCopy(Header, to, size, available);
      *(uint*)to = available;
      return true;
    }
  }

  /// Pixels that the library borrows. They are pinned during the lifetime of this object: create a few and reuse each when it IsFree.
  public sealed unsafe class Picture : IDisposable {
    [UnmanagedFunctionPointer(CallingConvention.Cdecl)] delegate int RetainFunction(IntPtr owner);
    [UnmanagedFunctionPointer(CallingConvention.Cdecl)] delegate void ReleaseFunction(IntPtr owner);
    static readonly RetainFunction retain = Retain;
    static readonly ReleaseFunction release = Release;
    static readonly IntPtr retainPointer = Marshal.GetFunctionPointerForDelegate(retain), releasePointer = Marshal.GetFunctionPointerForDelegate(release);

    public readonly byte[] Pixels;
    public readonly long Length;
    readonly GCHandle pin, self;
    readonly byte* data;
    int holds;

    /// Allocates the pixels.
    public Picture(int bytes) {
      Pixels = new byte[bytes];
      Length = bytes;
      pin = GCHandle.Alloc(Pixels, GCHandleType.Pinned);
      self = GCHandle.Alloc(this);
      data = (byte*)pin.AddrOfPinnedObject();
    }
    /// Wraps existing memory of `bytes` (a NativeArray, a camera buffer), which must stay valid until IsFree.
    public Picture(IntPtr pixels, long bytes) {
      Length = bytes;
      self = GCHandle.Alloc(this);
      data = (byte*)pixels;
    }
    public bool IsFree => Volatile.Read(ref holds) == 0;

    internal byte* Data => data;
    internal void Lend(ref Frame frame) {
      Interlocked.Increment(ref holds);
      frame.loan.owner = (void*)GCHandle.ToIntPtr(self);
      frame.loan.retain = retainPointer;
      frame.loan.release = releasePointer;
    }
    internal void Return() { Interlocked.Decrement(ref holds); }

    [MonoPInvokeCallback(typeof(RetainFunction))]
    static int Retain(IntPtr owner) { Interlocked.Increment(ref ((Picture)GCHandle.FromIntPtr(owner).Target).holds); return Abi.ODO_OK; }
    [MonoPInvokeCallback(typeof(ReleaseFunction))]
    static void Release(IntPtr owner) { ((Picture)GCHandle.FromIntPtr(owner).Target).Return(); }

    /// Call it only when IsFree, or after the session is disposed.
    public void Dispose() {
      if (pin.IsAllocated) pin.Free();
      if (self.IsAllocated) self.Free();
    }
  }

  /// Pool of pictures: reuses those that are free and grows to the number borrowed at one time. For one thread.
  public sealed class PicturePool : IDisposable {
    readonly System.Collections.Generic.List<Picture> pictures = new System.Collections.Generic.List<Picture>();
    readonly int bytes;
    public PicturePool(int bytes) { this.bytes = bytes; }

    public Picture Take() {
      for (int i = 0; i < pictures.Count; ++i)
        if (pictures[i].IsFree) return pictures[i];
      pictures.Add(new Picture(bytes));
      return pictures[pictures.Count - 1];
    }
    public int Borrowed {
      get {
        int count = 0;
        for (int i = 0; i < pictures.Count; ++i) count += pictures[i].IsFree ? 0 : 1;
        return count;
      }
    }
    public void Dispose() { foreach (Picture picture in pictures) picture.Dispose(); }
  }

  /// A session: one pipeline. Threads as in odograph.h.
  public sealed unsafe partial class Session : IDisposable {
    [UnmanagedFunctionPointer(CallingConvention.Cdecl)] delegate void Callback(IntPtr user, odo_header* header);
    static readonly Callback callback = OnEvent;
    public delegate void Handler(Event message);

    odo_session* session;
    readonly GCHandle self;
    Handler handler;
    volatile Exception thrown;
    volatile System.Threading.Thread calling;  // in the handler

    /// `config`: a YAML file, or its text. A text has a line break or ": " in it, as every YAML mapping has; a path with either is taken for one.
    public Session(string config, bool live = false, string pluginPath = "", string assetPath = "", ulong seed = 0) {
      OdographException.CheckAbi();
      byte[] yaml = Encoding.UTF8.GetBytes(config + "\0"), plugins = Encoding.UTF8.GetBytes(pluginPath + "\0"), assets = Encoding.UTF8.GetBytes(assetPath + "\0");
      var options = default(SessionOptions);
      var error = default(odo_error);
      options.struct_size = (uint)sizeof(SessionOptions);
      error.struct_size = (uint)sizeof(odo_error);
      options.run = live ? Abi.ODO_RUN_LIVE : Abi.ODO_RUN_REPLAY;
      options.seed = seed;
      odo_session* made;
      fixed (byte* y = yaml) fixed (byte* p = plugins) fixed (byte* a = assets) {
        var text = new odo_string {data = y, size = (ulong)yaml.Length - 1};
        if (config.IndexOf('\n') >= 0 || config.Contains(": ")) options.config_text = text; else options.config_path = text;
        options.plugin_path = new odo_string {data = p, size = (ulong)plugins.Length - 1};
        options.asset_path = new odo_string {data = a, size = (ulong)assets.Length - 1};
        OdographException.Check(Abi.odo_session_create(&options, &made, &error), &error);
      }
      session = made;
      self = GCHandle.Alloc(this);
    }

    /// Calls `function` with each event of these types (ODO_TYPE_*), or with all events if none is given: within Push and Flush, or on
    /// the library's thread when live. The next Push or Flush rethrows its exceptions.
    public void Listen(Handler function, params uint[] types) {
      handler = function;
      IntPtr pointer = Marshal.GetFunctionPointerForDelegate(callback);
      fixed (uint* t = types)
        OdographException.Check(Abi.odo_session_set_callback(session, t, types.Length == 0 ? Abi.ODO_ALL_EVENTS : (uint)types.Length, pointer, (void*)GCHandle.ToIntPtr(self)));
    }

    [MonoPInvokeCallback(typeof(Callback))]
    static void OnEvent(IntPtr user, odo_header* header) {
      var session = (Session)GCHandle.FromIntPtr(user).Target;
      System.Threading.Thread before = session.calling;
      session.calling = System.Threading.Thread.CurrentThread;
      try {
        session.handler(new Event(header));
      } catch (Exception e) {  // must not propagate through the library
        session.thrown = e;
      } finally {
        session.calling = before;
      }
    }

    int Checked(int status) {
      if (thrown != null) {
        Exception e = thrown;
        thrown = null;
        throw e;
      }
      return status;
    }

    /// Returns ODO_OK, or the status of a rejected message. There is an overload Push(ref message) for each input.
    public int Push(odo_header* message) { return Checked(Abi.odo_session_push(session, message)); }
    public int Push(Event message) { return Push(message.Header); }
    public int PushImu(long t_ns, Vector gyro, Vector accel) { return Checked(Abi.odo_session_push_imu(session, t_ns, &gyro.x, &accel.x)); }

    /// Pushes a frame with the pixels of a picture from byte `begin`, borrowed, not copied. Set format, width and height in the frame.
    public int PushFrame(ref Frame frame, Picture picture, int begin = 0, int rowStride = 0) {
      uint pixel = frame.format == Abi.ODO_FORMAT_RGB8 ? 3u : frame.format == Abi.ODO_FORMAT_RGBA8 || frame.format == Abi.ODO_FORMAT_BGRA8 ? 4u : 1u;
      frame.plane_count = 1;
      frame.planes0.data = picture.Data + begin;
      frame.planes0.row_stride = rowStride != 0 ? rowStride : (long)(frame.width * pixel);
      frame.planes0.pixel_stride = pixel;
      long end = begin + (frame.height - 1) * frame.planes0.row_stride + (long)frame.width * pixel;
      if (begin < 0 || frame.height == 0 || frame.planes0.row_stride < (long)frame.width * pixel || end > picture.Length)
        throw new ArgumentException("a frame of " + frame.width + " x " + frame.height + " with rows " + frame.planes0.row_stride + " bytes apart ends at byte " + end + " of a picture of " + picture.Length);
      picture.Lend(ref frame);
      try {
        fixed (Frame* f = &frame) return Push(&f->header);
      } finally {
        picture.Return();
      }
    }

    public void Flush() { OdographException.Check(Checked(Abi.odo_session_flush(session))); }

    /// Returns false before the first pose and outside the available times. Check the flags. `smooth`: without jumps, for rendering.
    public bool TryGetPose(out Pose pose, long t_ns = Abi.ODO_TIME_LATEST, bool smooth = false, uint of = Abi.ODO_OF_PIPELINE) {
      pose = new Pose(0);
      uint world = smooth ? Abi.ODO_WORLD_SMOOTH : Abi.ODO_WORLD_CORRECTED;
      fixed (Pose* p = &pose) return Abi.odo_session_get_pose_of(session, of, world, t_ns, p) == Abi.ODO_OK;
    }

    public Statistics GetStatistics() {
      var statistics = default(Statistics);
      statistics.struct_size = (uint)sizeof(Statistics);
      OdographException.Check(Abi.odo_session_get_statistics(session, &statistics));
      return statistics;
    }

    /// The latest error or warning since the last call, or null.
    public string LastError() {
      var error = default(odo_error);
      error.struct_size = (uint)sizeof(odo_error);
      OdographException.Check(Abi.odo_session_last_error(session, &error));
      return error.status == Abi.ODO_OK ? null : Marshal.PtrToStringAnsi((IntPtr)error.message);
    }

    public ulong CreateAnchor(AnchorPlace place, string name = "") {
      byte[] text = Encoding.UTF8.GetBytes(name + "\0");
      ulong id;
      place.struct_size = (uint)sizeof(AnchorPlace);
      fixed (byte* t = text) {
        place.name = new odo_string {data = t, size = (ulong)text.Length - 1};
        OdographException.Check(Abi.odo_anchor_create(session, &place, &id));
      }
      return id;
    }
    public bool TryGetAnchor(ulong id, out Anchor anchor, long t_ns = Abi.ODO_TIME_LATEST, uint world = Abi.ODO_WORLD_CORRECTED) {
      anchor = default(Anchor);
      anchor.struct_size = (uint)sizeof(Anchor);
      fixed (Anchor* a = &anchor) return Abi.odo_anchor_get(session, id, world, t_ns, a) == Abi.ODO_OK;
    }
    public bool RemoveAnchor(ulong id) { return Abi.odo_anchor_remove(session, id) == Abi.ODO_OK; }

    /// Maps of the places that this session has seen, with its anchors, for LoadMap in a later one; empty if there are none.
    public byte[] SaveMap() {
      var data = new byte[0];
      for (;;) {
        long size;
        fixed (byte* d = data) size = Abi.odo_map_save(session, d, (ulong)data.Length);
        if (size == data.Length) return data;
        OdographException.Check((int)Math.Min(size, 0));
        data = new byte[size];
      }
    }
    /// Throws if the map is damaged, or of plugins that the session does not have.
    public void LoadMap(byte[] data) {
      fixed (byte* d = data) OdographException.Check(Abi.odo_map_load(session, d, (ulong)data.Length));
    }

    /// What a ray hits, nearest first, at most hits.Length: returns the number, 0 while position or scale are unknown. Set kind, and pixel or
    /// origin and direction; t_ns as of the picture shown. To place something there, pass PlaceOf(hit) to CreateAnchor.
    public int HitTest(Ray ray, Hit[] hits) {
      if (hits.Length == 0) return 0;
      hits[0] = new Hit {struct_size = (uint)sizeof(Hit)};
      fixed (Hit* h = hits) return HitTest(ray, h, hits.Length);
    }
    /// The nearest of these; false if there is none.
    public bool TryHitTest(Ray ray, out Hit hit) {
      hit = new Hit {struct_size = (uint)sizeof(Hit)};
      fixed (Hit* h = &hit) return HitTest(ray, h, 1) > 0;
    }
    int HitTest(Ray ray, Hit* hits, int capacity) {
      uint count;
      ray.struct_size = (uint)sizeof(Ray);
      int status = Abi.odo_session_hit_test(session, &ray, hits, (uint)capacity, &count);
      if (status != Abi.ODO_E_NOT_FOUND) OdographException.Check(status); // no pose of that time: nothing is hit
      return (int)count;
    }
    public static AnchorPlace PlaceOf(Hit hit, uint world = Abi.ODO_WORLD_CORRECTED) {
      var place = default(AnchorPlace);
      place.kind = Abi.ODO_ANCHOR_HIT;
      place.t_ns = hit.t_ns;
      place.world = world;
      place.q = hit.q_n;
      place.p = hit.p_n;
      place.surface = hit.surface;
      place.sigma_m = hit.sigma_m;
      return place;
    }

    public static string StateText(uint state) { return Marshal.PtrToStringAnsi((IntPtr)Abi.odo_state_text(state)); }
    public static string ReasonText(uint reason) { return Marshal.PtrToStringAnsi((IntPtr)Abi.odo_reason_text(reason)); }

    /// Not within the handler of Listen, where it throws an InvalidOperationException.
    public void Dispose() {
      if (session == null) return;
      if (calling == System.Threading.Thread.CurrentThread) throw new InvalidOperationException("Dispose within Listen's handler: dispose of the session after Push or Flush has returned");
      Abi.odo_session_destroy(session);
      session = null;
      self.Free();
    }
  }

  /// A recording, which is read once: while (recording.Next(out message, out picture, out size)) ... Message and picture are valid until
  /// the next call.
  public sealed unsafe class Recording : IDisposable {
    odo_recording* recording;

    public Recording(string path) {
      OdographException.CheckAbi();
      byte[] name = Encoding.UTF8.GetBytes(path + "\0");
      var error = default(odo_error);
      error.struct_size = (uint)sizeof(odo_error);
      odo_recording* made;
      fixed (byte* n = name) {
        var text = new odo_string {data = n, size = (ulong)name.Length - 1};
        OdographException.Check(Abi.odo_recording_open(&text, &made, &error), &error);
      }
      recording = made;
    }

    /// Returns the next message in time order, and for a frame the encoded picture. Records that cannot be read are skipped; Loss() counts
    /// them.
    public bool Next(out Event message, out IntPtr picture, out int size) {
      odo_header* header;
      void* bytes;
      ulong count;
      int status;
      do status = Abi.odo_recording_next(recording, &header, &bytes, &count);
      while (status == Abi.ODO_E_DATA);
      OdographException.Check(status);
      bool there = status == Abi.ODO_OK;
      message = new Event(there ? header : null);
      picture = there ? (IntPtr)bytes : IntPtr.Zero;
      size = there ? (int)count : 0;
      return there;
    }

    /// Describes missing data; empty if the recording is complete.
    public string Loss() {
      var loss = default(odo_error);
      loss.struct_size = (uint)sizeof(odo_error);
      OdographException.Check(Abi.odo_recording_loss(recording, &loss));
      return Marshal.PtrToStringAnsi((IntPtr)loss.message);
    }

    public void Dispose() { Abi.odo_recording_close(recording); recording = null; }
  }
}
