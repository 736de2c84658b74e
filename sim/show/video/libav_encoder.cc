#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <optional>
#include <span>

#include "sim/base/error.h"
#include "sim/show/video/drawing_library.h"
#include "sim/show/video/gif_palette.h"

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

class LibavEncoder final : public VideoEncoder {
 public:
  LibavEncoder(const OutputFile& file, const VideoFormat& format) : file_(file), settings_(format) {
    if (settings_.encoder.empty()) {
      settings_.encoder = is_gif() ? "gif" : is_webm() ? "libvpx-vp9" : "libx264";
    }
  }

  ~LibavEncoder() override {
    sws_freeContext(converter_);
    av_packet_free(&packet_);
    av_frame_free(&frame_);
    avcodec_free_context(&codec_);
    if (container_ != nullptr && container_->pb != nullptr) avio_closep(&container_->pb);
    avformat_free_context(container_);
  }
  LibavEncoder(const LibavEncoder&) = delete;
  LibavEncoder& operator=(const LibavEncoder&) = delete;

  void Open() {
    OpenCodec();
    if (!is_gif()) OpenConverter();
    OpenFrame();
    OpenContainer();
  }

  void Add(ImageView image) override {
    if (image.width_px != settings_.width_px || image.height_px != settings_.height_px) {
      throw RunError(fmt::format("{}: a frame of {} x {} px in a video of {} x {} px", Target(),
                                 image.width_px, image.height_px, settings_.width_px,
                                 settings_.height_px));
    }
    Check(av_frame_make_writable(frame_), "reserve memory for a frame");
    is_gif() ? ConvertToPalette(image) : Convert(image);
    frame_->pts = next_frame_++;
    Encode(frame_);
  }

  void Finish() override {
    Encode(nullptr);
    Check(av_write_trailer(container_), "write");
    avio_flush(container_->pb);
    CheckWritten();
    Check(avio_closep(&container_->pb), "write");
  }

 private:
  bool is_webm() const { return settings_.container == Container::kWebm; }
  bool is_gif() const { return settings_.container == Container::kGif; }

  void Convert(ImageView image) {
    const std::uint8_t* rows[] = {reinterpret_cast<const std::uint8_t*>(image.pixels)};
    const int strides[] = {4 * image.width_px};
    sws_scale(converter_, rows, strides, 0, image.height_px, frame_->data, frame_->linesize);
  }

  void ConvertToPalette(ImageView image) {
    if (!palette_) {
      palette_.emplace(settings_.samples.empty() ? std::span<const ImageView>(&image, 1)
                                                 : std::span<const ImageView>(settings_.samples));
    }
    // Entries that no pixel has are transparent: the encoder uses the first for "as before".
    const std::span entries(reinterpret_cast<std::uint32_t*>(frame_->data[1]),
                            AVPALETTE_SIZE / sizeof(std::uint32_t));
    std::ranges::fill(entries, 0u);
    std::ranges::copy(palette_->colours(), entries.begin());
    for (int y = 0; y < image.height_px; ++y) {
      const std::span row(image.pixels + std::ptrdiff_t{y} * image.width_px,
                          static_cast<std::size_t>(image.width_px));
      std::ranges::transform(row, frame_->data[0] + std::ptrdiff_t{y} * frame_->linesize[0],
                             [this](std::uint32_t pixel) { return palette_->IndexOf(pixel); });
    }
  }

  std::string Target() const { return file_.target().string(); }

  int Check(int result, const char* action) const {
    if (result >= 0) return result;
    throw RunError(fmt::format("{}: cannot {}: {}", Target(), action, ReasonOf(result)));
  }

  void OpenCodec() {
    const AVCodec* encoder = avcodec_find_encoder_by_name(settings_.encoder.c_str());
    if (encoder == nullptr) {
      throw RunError(fmt::format("{}: cannot encode: this machine's libavcodec has no encoder {}",
                                 Target(), settings_.encoder));
    }
    codec_ = avcodec_alloc_context3(encoder);
    codec_->width = settings_.width_px;
    codec_->height = settings_.height_px;
    codec_->pix_fmt = is_gif() ? AV_PIX_FMT_PAL8 : AV_PIX_FMT_YUV420P;
    codec_->time_base = {1, settings_.frames_per_s};
    codec_->framerate = {settings_.frames_per_s, 1};
    codec_->sample_aspect_ratio = {1, 1};
    codec_->gop_size = 2 * settings_.frames_per_s;  // seek to within two seconds
    codec_->thread_count = kEncoderThreads;
    if (!is_gif()) {
      codec_->color_range = AVCOL_RANGE_MPEG;
      codec_->colorspace = AVCOL_SPC_BT709;
      codec_->color_primaries = AVCOL_PRI_BT709;
      codec_->color_trc = AVCOL_TRC_BT709;
    }
    codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // Encoders without these options do without them.
    av_opt_set(codec_->priv_data, "preset", settings_.preset.c_str(), 0);
    av_opt_set_int(codec_->priv_data, "crf", settings_.rate_factor, 0);
    if (is_webm()) {
      av_opt_set(codec_->priv_data, "deadline", "good", 0);
      av_opt_set_int(codec_->priv_data, "cpu-used", 5, 0);  // as fast as keeps text crisp
      av_opt_set_int(codec_->priv_data, "row-mt", 1, 0);
    }
    Check(avcodec_open2(codec_, encoder, nullptr), "open the encoder");
  }

  void OpenConverter() {
    converter_ = sws_getContext(settings_.width_px, settings_.height_px, AV_PIX_FMT_BGR0,
                                settings_.width_px, settings_.height_px, codec_->pix_fmt,
                                SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
    if (converter_ == nullptr) throw RunError("video: cannot convert colours");
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(converter_, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
  }

  void OpenFrame() {
    frame_ = av_frame_alloc();
    packet_ = av_packet_alloc();
    frame_->format = codec_->pix_fmt;
    frame_->width = codec_->width;
    frame_->height = codec_->height;
    Check(av_frame_get_buffer(frame_, 0), "reserve memory for a frame");
  }

  void OpenContainer() {
    const std::string path = file_.temporary_path().string();
    // The temporary name does not end in .mp4, .webm or .gif, so the container is said.
    const char* name = is_gif() ? "gif" : is_webm() ? "webm" : "mp4";
    Check(avformat_alloc_output_context2(&container_, nullptr, name, path.c_str()),
          "write a video");
    stream_ = avformat_new_stream(container_, nullptr);
    stream_->time_base = codec_->time_base;
    stream_->avg_frame_rate = codec_->framerate;
    Check(avcodec_parameters_from_context(stream_->codecpar, codec_), "write a video");
    if (!is_gif()) AddChapters();
    Check(avio_open(&container_->pb, path.c_str(), AVIO_FLAG_WRITE), "write");
    av_opt_set(container_->priv_data, "movflags", "+faststart", 0);
    container_->flags |= AVFMT_FLAG_BITEXACT;  // no library versions, no times in the file
    Check(avformat_write_header(container_, nullptr), "write");
  }

  /// They and their list belong to the container, which frees them.
  void AddChapters() {
    const std::vector<Chapter>& chapters = settings_.chapters;
    if (chapters.empty()) return;
    container_->chapters = static_cast<AVChapter**>(av_calloc(chapters.size(), sizeof(AVChapter*)));
    for (const Chapter& chapter : chapters) {
      auto* added = static_cast<AVChapter*>(av_mallocz(sizeof(AVChapter)));
      if (container_->chapters == nullptr || added == nullptr) {
        av_free(added);
        throw RunError(Target() + ": not enough memory for chapters");
      }
      container_->chapters[container_->nb_chapters++] = added;
      added->id = container_->nb_chapters;
      added->time_base = codec_->time_base;
      added->start = chapter.begin;
      added->end = chapter.end;
      av_dict_set(&added->metadata, "title", chapter.title.c_str(), 0);
    }
  }

  /// A null frame empties the encoder.
  void Encode(AVFrame* next) {
    Check(avcodec_send_frame(codec_, next), "encode");
    for (;;) {
      const int received = avcodec_receive_packet(codec_, packet_);
      if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
      Check(received, "encode");
      packet_->duration = 1;
      av_packet_rescale_ts(packet_, codec_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      Check(av_interleaved_write_frame(container_, packet_), "write");
      CheckWritten();
    }
  }

  /// The writer remembers its first failure, a full disk for example.
  void CheckWritten() const { Check(container_->pb->error, "write"); }

  const OutputFile& file_;
  VideoFormat settings_;
  AVCodecContext* codec_ = nullptr;
  AVFormatContext* container_ = nullptr;
  AVStream* stream_ = nullptr;
  AVFrame* frame_ = nullptr;
  AVPacket* packet_ = nullptr;
  SwsContext* converter_ = nullptr;    // of all but GIF
  std::optional<GifPalette> palette_;  // of a GIF, from the first frame on
  std::int64_t next_frame_ = 0;
};

}  // namespace

std::unique_ptr<VideoEncoder> OpenLibavEncoder(const OutputFile& file, const VideoFormat& format) {
  av_log_set_level(AV_LOG_QUIET);
  CheckFormat(format);
  auto encoder = std::make_unique<LibavEncoder>(file, format);
  encoder->Open();
  return encoder;
}

}  // namespace gauntlet::sim
