// One time of the motion [s] for the hand, the curves, the video and the address. Whoever sets it names itself and is not
// told again. null: there is none, as where the pointer has left the curves.
class SharedTime {
  constructor() {
    this.now = null;
    this.listeners = [];
  }

  listen(who, react) { this.listeners.push({who, react}); }

  // `settled`: a person chose it, so the video jumps there and the address names it.
  set(time_s, by, settled = false) {
    this.now = time_s;
    for (const {who, react} of this.listeners) {
      if (who !== by) react(time_s, settled);
    }
  }
}

// comparison.mp4, whose frames set the time while it plays by its own controls.
class SharedVideo {
  // `stretches`: [[video_s, from_s, to_s, speed]..], parts that show the motion.
  constructor(video, stretches, time) {
    Object.assign(this, {video, stretches, time});
    this.led = false;  // by the hand, which plays
    this.wanted_s = null;  // of a seek by the page
    this.onPause = null;  // by a person
    time.listen("video", (time_s, settled) => {
      if (settled && time_s !== null) this.seek(time_s);
    });
    const follow = () => {
      if (!this.led && !video.paused) this.tell();
      this.nextFrame(follow);
    };
    this.nextFrame(follow);
    video.addEventListener("seeked", () => {
      // A person moved it. What the page asked for may come out a little later in a video that was just stopped.
      if (this.wanted_s === null && video.paused && !this.led) this.tell();
      else if (this.wanted_s !== null && Math.abs(video.currentTime - this.wanted_s) > 0.02) video.currentTime = this.wanted_s;
      this.wanted_s = null;
    });
    video.addEventListener("pause", () => {
      if (this.led && !video.ended) this.onPause?.();
    });
  }

  nextFrame(follow) {
    if (this.video.requestVideoFrameCallback) this.video.requestVideoFrameCallback(follow);
    else this.video.addEventListener("timeupdate", follow, {once: true});
  }

  motionAt(video_s) {
    const at = this.stretches.findLast(([begin]) => video_s >= begin - 1e-6);
    if (!at) return null;
    const moment = at[1] + (video_s - at[0]) * at[3];
    return moment <= at[2] ? moment : null;
  }

  tell() {
    const moment = this.motionAt(this.video.currentTime);
    if (moment !== null) this.time.set(moment, "video");
  }

  seek(time_s) {
    const [begin, from, , speed] = this.stretches[0];
    const video_s = begin + (time_s - from) / speed;
    if (this.video.readyState > 0) this.wanted_s = video_s;
    this.video.currentTime = video_s;
  }

  // The hand plays: the video runs with it.
  lead(time_s, speed) {
    if (this.video.readyState < 2) return;
    this.led = true;
    this.video.playbackRate = Math.max(0.0625, speed);
    const moment = this.motionAt(this.video.currentTime);
    if (moment === null || this.video.currentTime > this.stretches[0][0] + this.stretches[0][2] ||
        Math.abs(moment - time_s) > 0.1) this.seek(time_s);
    if (this.video.paused) this.video.play().catch(() => {});
  }

  leave() {
    if (!this.led) return;
    this.led = false;
    this.video.pause();
    this.video.playbackRate = 1;
  }
}
