// SPDX-License-Identifier: Apache-2.0
// A frame through C# is neither copied nor allocated: the plugin receives the pinned array itself, the garbage
// collector allocates
// nothing, and the process less than once per two frames (Mono's compiler does, at first).
using System;
using System.Runtime.InteropServices;
using Odograph;

static unsafe class NoCopy {
  const string Config = "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\nvo_frontend: {plugin: test/pixels}\ncoupling: {type: localizer}\n";
  const int Width = 640, Height = 480, Warm = 200, Frames = 400;
  [DllImport("__Internal")] static extern void odo_test_count(ulong bytes);
  [DllImport("__Internal")] static extern ulong odo_test_all();
  [DllImport("__Internal")] static extern ulong odo_test_large();
  [DllImport("__Internal")] static extern IntPtr odo_test_seen();

  static int poses, foreign;
  static double north;
  static Picture[] pictures = new Picture[12];

  static void Take(Event message) {
    Pose pose;
    if (!message.TryGet(out pose)) return;
    ++poses;
    north += pose.p_n.x;
  }

  static void Push(Session session, int number) {
    long t_ns = 1000000000L + number * 40000000L;
    for (int k = 0; k < 4; ++k) session.PushImu(t_ns + k * 10000000L, new Vector(0, 0.01, 0), new Vector(0.1, 9.81, 0.4));
    var frame = new Frame(t_ns) {format = Abi.ODO_FORMAT_GREY8, width = Width, height = Height};
    session.PushFrame(ref frame, pictures[number % pictures.Length]);
    Pose pose;
    session.TryGetPose(out pose);
    IntPtr seen = odo_test_seen();
    for (int i = 0; i < pictures.Length; ++i)
      fixed (byte* pixels = pictures[i].Pixels)
        if ((IntPtr)pixels == seen) return;
    ++foreign;
  }

  static int Main() {
    for (int i = 0; i < pictures.Length; ++i) pictures[i] = new Picture(Width * Height);
    ulong all, large, frames, counted;
    long managed, collections;
    using (new Session("{odograph: 1, attitude: {plugin: attitude/vqf}}")) {}  // a text of one line
    using (var session = new Session(Config)) {
      session.Listen(Take, Abi.ODO_TYPE_POSE);
      for (int i = 0; i < Warm; ++i) Push(session, i);
      var tall = new Frame(0) {format = Abi.ODO_FORMAT_GREY8, width = Width, height = Height + 1};
      try {
        session.PushFrame(ref tall, pictures[0]);
        Console.Error.WriteLine("a frame larger than its picture was taken");
        return 1;
      } catch (ArgumentException) {
      }
      foreign = 0;
      GC.Collect();
      collections = GC.CollectionCount(0);
      odo_test_count(Width * Height / 4);
      managed = GC.GetAllocatedBytesForCurrentThread();
      for (int i = Warm; i < Warm + Frames; ++i) Push(session, i);
      managed = GC.GetAllocatedBytesForCurrentThread() - managed;
      all = odo_test_all();
      large = odo_test_large();
      collections = GC.CollectionCount(0) - collections;
      frames = session.GetStatistics().frames;
      long before = GC.GetAllocatedBytesForCurrentThread();  // the counters work
      GC.KeepAlive(new byte[Width * Height]);
      Marshal.FreeHGlobal(Marshal.AllocHGlobal(Width * Height));
      counted = GC.GetAllocatedBytesForCurrentThread() - before >= Width * Height ? odo_test_large() - large : 0;
    }
    int borrowed = 0;
    foreach (Picture picture in pictures) borrowed += picture.IsFree ? 0 : 1;
    Console.WriteLine("C#: " + frames + " frames, " + Frames + " of them counted: " + foreign + " at another address, " + managed + " bytes of the garbage collector's, " +
                      collections + " collections, " + all + " native allocations, " + large + " of a picture's size; " + poses + " poses; " + borrowed + " still borrowed");
    return frames < Warm + Frames - 5 || foreign != 0 || managed != 0 || collections != 0 || large != 0 || all > Frames / 2 || counted == 0 || poses < Frames || borrowed != 0 ? 1 : 0;
  }
}
