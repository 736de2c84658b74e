#include "sim/video/video_encoder.h"

#include <fmt/format.h>

#include <cerrno>

#include "sim/base/error.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace gauntlet::sim {
namespace {

// A fixed number: x264 gives other bytes for another number of threads.
constexpr int kEncoderThreads = 2;
constexpr int kLargestSide_px = 8192;
constexpr int kLargestRate_hz = 240;
constexpr int kLargestRateOfGif_hz = 50;  // a shorter pause is taken for a mistake

std::string ReasonOf(int error) {
  // libx264 says no more than that; memory is what it fails for.
  if (error == AVERROR_EXTERNAL) return "the encoder failed, as it does with too little memory";
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof(text));
  return text;
}

void CheckFormat(const VideoFormat& format) {
  const auto check_side = [](const char* name, int side) {
    if (side < 2 || side > kLargestSide_px || side % 2 != 0) {
      throw UserError(fmt::format("video: {} {} is not an even number in 2 .. {}", name, side,
                                  kLargestSide_px));
    }
  };
  check_side("width_px", format.width_px);
  check_side("height_px", format.height_px);
  if (format.frames_per_s < 1 || format.frames_per_s > kLargestRate_hz) {
    throw UserError(fmt::format("video: frames_per_s {} is not in 1 .. {}", format.frames_per_s,
                                kLargestRate_hz));
  }
  if (format.container == Container::kGif && format.frames_per_s > kLargestRateOfGif_hz) {
    throw UserError(
        fmt::format("video: frames_per_s {} is too much for a GIF, of which browsers "
                    "show {}",
                    format.frames_per_s, kLargestRateOfGif_hz));
  }
}

}  // namespace

struct VideoEncoder::State {
  const AtomicFile& file;
  VideoFormat settings;
  AVCodecContext* codec = nullptr;
  AVFormatContext* container = nullptr;
  AVStream* stream = nullptr;
  AVFrame* frame = nullptr;
  AVPacket* packet = nullptr;
  SwsContext* converter = nullptr;
  std::int64_t next_frame = 0;

  State(const AtomicFile& given_file, const VideoFormat& format)
      : file(given_file), settings(format) {
    if (settings.encoder.empty()) {
      settings.encoder = is_gif() ? "gif" : is_webm() ? "libvpx-vp9" : "libx264";
    }
  }

  bool is_webm() const { return settings.container == Container::kWebm; }
  bool is_gif() const { return settings.container == Container::kGif; }

  ~State() {
    sws_freeContext(converter);
    av_packet_free(&packet);
    av_frame_free(&frame);
    avcodec_free_context(&codec);
    if (container != nullptr && container->pb != nullptr) avio_closep(&container->pb);
    avformat_free_context(container);
  }

  std::string Target() const { return file.target().string(); }

  int Check(int result, const char* action) const {
    if (result >= 0) return result;
    throw RunError(fmt::format("{}: cannot {}: {}", Target(), action, ReasonOf(result)));
  }

  void OpenCodec() {
    const AVCodec* encoder = avcodec_find_encoder_by_name(settings.encoder.c_str());
    if (encoder == nullptr) {
      throw RunError(fmt::format("{}: cannot encode: this machine's libavcodec has no encoder {}",
                                 Target(), settings.encoder));
    }
    codec = avcodec_alloc_context3(encoder);
    codec->width = settings.width_px;
    codec->height = settings.height_px;
    codec->pix_fmt = is_gif() ? AV_PIX_FMT_RGB8 : AV_PIX_FMT_YUV420P;
    codec->time_base = {1, settings.frames_per_s};
    codec->framerate = {settings.frames_per_s, 1};
    codec->sample_aspect_ratio = {1, 1};
    codec->gop_size = 2 * settings.frames_per_s;  // seek to within two seconds
    codec->thread_count = kEncoderThreads;
    if (!is_gif()) {
      codec->color_range = AVCOL_RANGE_MPEG;
      codec->colorspace = AVCOL_SPC_BT709;
      codec->color_primaries = AVCOL_PRI_BT709;
      codec->color_trc = AVCOL_TRC_BT709;
    }
    codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // Encoders without these options do without them.
    av_opt_set(codec->priv_data, "preset", settings.preset.c_str(), 0);
    av_opt_set_int(codec->priv_data, "crf", settings.rate_factor, 0);
    if (is_webm()) {
      av_opt_set(codec->priv_data, "deadline", "good", 0);
      av_opt_set_int(codec->priv_data, "cpu-used", 5, 0);  // as fast as keeps text crisp
      av_opt_set_int(codec->priv_data, "row-mt", 1, 0);
    }
    Check(avcodec_open2(codec, encoder, nullptr), "open the encoder");
  }

  void OpenConverter() {
    converter = sws_getContext(settings.width_px, settings.height_px, AV_PIX_FMT_BGR0,
                               settings.width_px, settings.height_px, codec->pix_fmt,
                               SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
    if (converter == nullptr) throw RunError("video: cannot convert colours");
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(converter, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    frame = av_frame_alloc();
    packet = av_packet_alloc();
    frame->format = codec->pix_fmt;
    frame->width = codec->width;
    frame->height = codec->height;
    Check(av_frame_get_buffer(frame, 0), "reserve memory for a frame");
  }

  void OpenContainer() {
    const std::string path = file.temporary_path().string();
    // The temporary name does not end in .mp4, .webm or .gif, so the container is said.
    const char* name = is_gif() ? "gif" : is_webm() ? "webm" : "mp4";
    Check(avformat_alloc_output_context2(&container, nullptr, name, path.c_str()), "write a video");
    stream = avformat_new_stream(container, nullptr);
    stream->time_base = codec->time_base;
    stream->avg_frame_rate = codec->framerate;
    Check(avcodec_parameters_from_context(stream->codecpar, codec), "write a video");
    if (!is_gif()) AddChapters();
    Check(avio_open(&container->pb, path.c_str(), AVIO_FLAG_WRITE), "write");
    av_opt_set(container->priv_data, "movflags", "+faststart", 0);
    container->flags |= AVFMT_FLAG_BITEXACT;  // no library versions, no times in the file
    Check(avformat_write_header(container, nullptr), "write");
  }

  /// They and their list belong to the container, which frees them.
  void AddChapters() {
    const std::vector<Chapter>& chapters = settings.chapters;
    if (chapters.empty()) return;
    container->chapters = static_cast<AVChapter**>(av_calloc(chapters.size(), sizeof(AVChapter*)));
    for (const Chapter& chapter : chapters) {
      auto* added = static_cast<AVChapter*>(av_mallocz(sizeof(AVChapter)));
      if (container->chapters == nullptr || added == nullptr) {
        av_free(added);
        throw RunError(Target() + ": not enough memory for chapters");
      }
      container->chapters[container->nb_chapters++] = added;
      added->id = container->nb_chapters;
      added->time_base = codec->time_base;
      added->start = chapter.begin;
      added->end = chapter.end;
      av_dict_set(&added->metadata, "title", chapter.title.c_str(), 0);
    }
  }

  /// A null frame empties the encoder.
  void Encode(AVFrame* next) {
    Check(avcodec_send_frame(codec, next), "encode");
    for (;;) {
      const int received = avcodec_receive_packet(codec, packet);
      if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
      Check(received, "encode");
      packet->duration = 1;
      av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      Check(av_interleaved_write_frame(container, packet), "write");
      CheckWritten();
    }
  }

  /// The writer remembers its first failure, a full disk for example.
  void CheckWritten() const { Check(container->pb->error, "write"); }
};

Container ContainerOf(const std::filesystem::path& file) {
  if (file.extension() == ".gif") return Container::kGif;
  return file.extension() == ".webm" ? Container::kWebm : Container::kMp4;
}

VideoEncoder::VideoEncoder(const AtomicFile& file, const VideoFormat& format) {
  av_log_set_level(AV_LOG_QUIET);
  CheckFormat(format);
  state_ = std::make_unique<State>(file, format);
  state_->OpenCodec();
  state_->OpenConverter();
  state_->OpenContainer();
}

VideoEncoder::~VideoEncoder() = default;

void VideoEncoder::Add(ImageView image) {
  State& state = *state_;
  if (image.width_px != state.settings.width_px || image.height_px != state.settings.height_px) {
    throw RunError(fmt::format("{}: a frame of {} x {} px in a video of {} x {} px", state.Target(),
                               image.width_px, image.height_px, state.settings.width_px,
                               state.settings.height_px));
  }
  state.Check(av_frame_make_writable(state.frame), "reserve memory for a frame");
  const std::uint8_t* rows[] = {reinterpret_cast<const std::uint8_t*>(image.pixels)};
  const int strides[] = {4 * image.width_px};
  sws_scale(state.converter, rows, strides, 0, image.height_px, state.frame->data,
            state.frame->linesize);
  state.frame->pts = state.next_frame++;
  state.Encode(state.frame);
}

void VideoEncoder::Finish() {
  State& state = *state_;
  state.Encode(nullptr);
  state.Check(av_write_trailer(state.container), "write");
  avio_flush(state.container->pb);
  state.CheckWritten();
  state.Check(avio_closep(&state.container->pb), "write");
}

}  // namespace gauntlet::sim
