// SPDX-License-Identifier: Apache-2.0
// Reads a recording, and tracks a walk live, in C#.
//   Walk.exe CONFIG.yaml RECORDING.odo
using System;
using System.Globalization;
using System.Runtime.InteropServices;
using Odograph;

static class Walk {
  const string Config = @"odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}
";

  static string Digits(params double[] numbers) { return string.Join(" ", Array.ConvertAll(numbers, x => x.ToString("G17", CultureInfo.InvariantCulture))); }

  static unsafe void Show(Event message) {
    uint points = 0;
    while (message.Landmark(points) != null) ++points;
    if (points > 0) {  // landmarks, the most certain first
      Point* first = message.Landmark(0);
      Console.WriteLine("points " + points + " first " + first->id + " " + Digits(first->p_c[2]));
    }
    Pose pose;
    if (!message.TryGet(out pose)) return;
    Console.WriteLine("pose " + pose.header.t_ns + " " + Digits(pose.p_n.x, pose.p_n.y, pose.p_n.z, pose.q_n.x, pose.q_n.y, pose.q_n.z, pose.q_n.w));
  }

  /// Offset of the pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library.
  static int Decode(byte[] picture, ref Frame frame) {
    if (picture[0] != 'P' || picture[1] != '5') throw new Exception("a frame is not PGM; make such a recording by `odograph convert --pgm`");
    string[] head = System.Text.Encoding.ASCII.GetString(picture, 0, 24).Split(' ', '\n');
    frame.format = Abi.ODO_FORMAT_GREY8;
    frame.width = uint.Parse(head[1]);
    frame.height = uint.Parse(head[2]);
    return head[0].Length + head[1].Length + head[2].Length + head[3].Length + 4;
  }

  /// Puts an anchor on what lies ahead, 45 degrees down: usually the floor.
  static void Place(Session session) {
    Hit hit;
    if (!session.TryHitTest(new Ray {kind = Abi.ODO_RAY_VIEW, t_ns = Abi.ODO_TIME_LATEST, direction = new Vector(0, 1, 1)}, out hit)) return;
    ulong anchor = session.CreateAnchor(Session.PlaceOf(hit), "on the floor");
    Console.WriteLine("hit " + hit.what + " " + hit.surface + " " + Digits(hit.distance_m) + " anchor " + anchor);
  }

  static void Replay(string config, string file) {
    using (var pictures = new PicturePool(1 << 20))
    using (var session = new Session(config))
    using (var recording = new Recording(file)) {
      session.Listen(Show, Abi.ODO_TYPE_POSE, Abi.ODO_TYPE_POINTS);
      Event message;
      IntPtr encoded;
      int size;
      while (recording.Next(out message, out encoded, out size)) {
        Frame frame;
        if (message.TryGet(out frame)) {
          Picture picture = pictures.Take();
          Marshal.Copy(encoded, picture.Pixels, 0, size);
          session.PushFrame(ref frame, picture, Decode(picture.Pixels, ref frame));
        } else if (message.IsInput) {
          session.Push(message);
        }
      }
      session.Flush();
      Place(session);
    }
  }

  static void Live() {
    int steps = 0;
    using (var pictures = new PicturePool(64 * 48))  // as from a camera
    using (var session = new Session(Config, live: true)) {
      session.Listen(message => ++steps, Abi.ODO_TYPE_STEP);
      for (int i = 0; i < 1000; ++i) {
        double t = i * 0.01;
        long t_ns = 1000000000L + i * 10000000L;
        session.PushImu(t_ns, new Vector(0, 0.01, 0), new Vector(0.1, 9.81 + 2.2 * Math.Sin(12 * t), 0.4));
        if (i % 10 != 0) continue;
        var frame = new Frame(t_ns) {format = Abi.ODO_FORMAT_GREY8, width = 64, height = 48};
        Picture picture = pictures.Take();
        for (int k = 0; k < picture.Pixels.Length; ++k) picture.Pixels[k] = 90;
        session.PushFrame(ref frame, picture);  // borrowed, not copied
        session.Flush();  // needed only because the simulated time does not wait
      }
      Pose pose;
      session.TryGetPose(out pose);
      ulong label = session.CreateAnchor(new AnchorPlace {kind = Abi.ODO_ANCHOR_VIEW, t_ns = Abi.ODO_TIME_LATEST, p = new Vector(0, 0, -3)}, "a label");
      Anchor anchor;
      session.TryGetAnchor(label, out anchor);
      Console.WriteLine("live " + steps + " steps " + Digits(pose.p_n.x, pose.p_n.y, pose.p_n.z) + " label " +
                        string.Format(CultureInfo.InvariantCulture, "{0:F2} {1:F2} {2:F2}", anchor.p_n.x, anchor.p_n.y, anchor.p_n.z) + " borrowed " + pictures.Borrowed);
    }
  }

  static int Main(string[] args) {
    if (args.Length != 2) {
      Console.Error.WriteLine("usage: Walk.exe CONFIG.yaml RECORDING.odo");
      return 2;
    }
    Replay(args[0], args[1]);
    Live();
    return 0;
  }
}
